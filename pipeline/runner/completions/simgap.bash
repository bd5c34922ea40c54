# Completion of simgap in bash; add to ~/.bashrc:   eval "$(simgap --completion bash)"
_simgap() {
    local line=${COMP_LINE:0:COMP_POINT} word stem
    local -a words
    read -ra words <<< "$line"
    [[ $line == *[[:space:]] ]] && words+=("")
    word=${words[${#words[@]}-1]}
    local IFS=$'\n'
    COMPREPLY=($("${words[0]}" --complete "${words[@]:1}" 2> /dev/null))
    # Bash takes what follows an equals sign for a word of its own.
    if [[ $word == *=* && $COMP_WORDBREAKS == *=* ]]; then
        stem=${word%"${word##*=}"}
        COMPREPLY=("${COMPREPLY[@]#"$stem"}")
    fi
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=./] ]]; then
        compopt -o nospace 2> /dev/null
    fi
}
complete -o default -F _simgap simgap
