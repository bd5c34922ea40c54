"""Floor 5: the equations of motion on a recording, row by row: residuals, their noise, and how they are fitted."""
