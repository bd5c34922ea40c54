#compdef simgap
# Completion of simgap in zsh; add to ~/.zshrc after compinit:   eval "$(simgap --completion zsh)"
_simgap() {
    local -a found
    found=(${(f)"$("${words[1]}" --complete "${(@)words[2,CURRENT]}" 2> /dev/null)"})
    if (( $#found )); then
        compadd -Q -S '' -- $found
    else
        compset -P '*='
        _files
    fi
}
compdef _simgap simgap
