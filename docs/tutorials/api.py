# %% [markdown]
# # The Python API

# %%
import simgap

simgap.__doc__
