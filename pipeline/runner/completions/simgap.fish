# Completion of simgap in fish; add to ~/.config/fish/config.fish:   simgap --completion fish | source
function __simgap_candidates
    set -l before (commandline -opc)
    set -l word (commandline -ct)
    $before[1] --complete $before[2..-1] "$word" 2> /dev/null
end
complete -c simgap -n 'test (count (commandline -opc)) -eq 1' -f -a '(__simgap_candidates)'
complete -c simgap -n 'test (count (commandline -opc)) -gt 1' -a '(__simgap_candidates)'
