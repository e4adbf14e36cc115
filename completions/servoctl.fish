# Completion of servoctl for fish; written by `servoctl completion fish`.
# The program is asked what may stand at the cursor: it reads files, opens no bus and sends nothing.
function __servoctl_complete
    set -l words (commandline -opc)
    set -l begun (commandline -ct)
    set -l program servoctl
    string match -q -- '*/*' $words[1]; and test -x $words[1]; and set program $words[1]
    set -e words[1]
    # A word that is a variable stands for its value; nothing else is expanded.
    for i in (seq (count $words))
        set -l name (string replace -rf -- '^"?\{?\$([A-Za-z_][A-Za-z0-9_]*)\}?"?$' '$1' $words[$i])
        and set -q $name
        and set words[$i] "$$name"
    end
    set -l answer ($program __complete fish "$begun" $words 2>/dev/null)
    switch "$answer[1]"
        case 'note*'
            printf '\n(%s)\n' (string sub -s 6 -- $answer[1]) >&2
            commandline -f repaint
        case '*'
            set -e answer[1]
            printf '%s\n' $answer
    end
end

complete -c servoctl -f -k -a '(__servoctl_complete)'
