# Completion of servoctl for fish; written by `servoctl completion fish`.
function __servoctl_drive
    set -l words (commandline -opc)
    for i in (seq 2 (count $words))
        if contains -- $words[(math $i - 1)] -d --drive
            echo $words[$i]
            return
        end
    end
    echo $SERVOCTL_DRIVE
end

function __servoctl_path # the words that are neither options nor their values
    set -l skip 0
    set -l path
    for word in (commandline -opc)[2..]
        if test $skip = 1
            set skip 0
        else if contains -- $word --bus -b --node -n --drive -d --timeout --retries --output -o --lang --trace --type --to --transfer --from --only --for --guard --life --var
            set skip 1
        else if not string match -q -- '-*' $word
            set path $path $word
        end
    end
    string join \n -- $path
end

function __servoctl_at # these words and no more
    set -l path (__servoctl_path)
    test "$path" = "$argv"
end

function __servoctl_in # these words first
    set -l path (__servoctl_path)
    set -l n (count $argv)
    test (count $path) -ge $n; and test "$path[1..$n]" = "$argv"
end

function __servoctl_names
    set -l drive (__servoctl_drive)
    test -n "$drive"; and servoctl completion $argv[1] -d $drive 2>/dev/null
end

function __servoctl_buses
    for interface in /sys/class/net/*
        test (cat $interface/type 2>/dev/null; or echo 0) = 280; and basename $interface
    end
    echo sim:
    echo local:
end

complete -c servoctl -f
complete -c servoctl -l bus -s b -x -a '(__servoctl_buses)' -d 'bus: can0, local:NAME, sim:gsd600@1 (default $SERVOCTL_BUS)'
complete -c servoctl -l node -s n -x -a 'all' -d 'node-ID, a list 1,3,5-8 or all (default $SERVOCTL_NODE)'
complete -c servoctl -l drive -s d -x -a '(servoctl completion families 2>/dev/null)' -d 'drive family or an .eds file (default $SERVOCTL_DRIVE)'
complete -c servoctl -l timeout -x -d 'longest wait for one answer (default 500ms)'
complete -c servoctl -l retries -x -d 'further tries of a read without answer (default 1); a write is never repeated'
complete -c servoctl -l json -d 'one JSON document instead of text'
complete -c servoctl -l output -s o -x -a 'text json jsonl' -d 'text, json, or jsonl for one document a sample'
complete -c servoctl -l lang -x -a 'en zh' -d 'language of names: en or zh (default $SERVOCTL_LANG)'
complete -c servoctl -l yes -s y -d 'answer yes to what would be asked'
complete -c servoctl -l read-only -d 'refuse everything that changes a drive'
complete -c servoctl -l dry-run -d 'show the frames, send nothing that changes a drive'
complete -c servoctl -l trace -r -F -d 'write every frame into a file (candump -L form)'
complete -c servoctl -l help -s h -d 'show the help of the command'
complete -c servoctl -n __servoctl_at -a scan -d 'Find the nodes on the bus and what they are'
complete -c servoctl -n __servoctl_at -a info -d 'Show the identity of a node'
complete -c servoctl -n __servoctl_at -a status -d 'Show the state of a drive: NMT, CiA 402, mode, fault'
complete -c servoctl -n __servoctl_at -a read -d 'Read objects of a node'
complete -c servoctl -n '__servoctl_in read' -x -a '(__servoctl_names objects)'
complete -c servoctl -n '__servoctl_in read' -l type -x -a 'bool i8 i16 i24 i32 i64 u8 u16 u24 u32 u64 f32 f64 string bytes domain' -d 'data type, when the dictionary does not know it'
complete -c servoctl -n '__servoctl_in read' -l to -r -F -d 'put the bytes of one object into this file'
complete -c servoctl -n '__servoctl_in read' -l transfer -x -a 'auto expedited segmented block' -d 'how the bytes travel: by size unless said'
complete -c servoctl -n __servoctl_at -a write -d 'Write one object of a node'
complete -c servoctl -n '__servoctl_in write' -x -a '(__servoctl_names objects)'
complete -c servoctl -n '__servoctl_in write' -l type -x -a 'bool i8 i16 i24 i32 i64 u8 u16 u24 u32 u64 f32 f64 string bytes domain' -d 'data type, when the dictionary does not know it'
complete -c servoctl -n '__servoctl_in write' -l from -r -F -d 'write the bytes of this file instead of a value'
complete -c servoctl -n '__servoctl_in write' -l transfer -x -a 'auto expedited segmented block' -d 'how the bytes travel: by size unless said'
complete -c servoctl -n '__servoctl_in write' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in write' -l unlock -d 'give the family'\''s password before, take it back after'
complete -c servoctl -n __servoctl_at -a objects -d 'List the object dictionary of a drive family'
complete -c servoctl -n '__servoctl_at param' -a list -d 'List the panel parameters of a drive family'
complete -c servoctl -n '__servoctl_at param' -a get -d 'Read panel parameters of a drive'
complete -c servoctl -n '__servoctl_in param get' -x -a '(__servoctl_names parameters)'
complete -c servoctl -n '__servoctl_at param' -a set -d 'Change panel parameters of a drive and read them back'
complete -c servoctl -n '__servoctl_in param set' -x -a '(__servoctl_names parameters)'
complete -c servoctl -n '__servoctl_in param set' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in param set' -l unlock -d 'give the family'\''s password before, take it back after'
complete -c servoctl -n '__servoctl_at param' -a search -d 'Find panel parameters by words, in English or Chinese'
complete -c servoctl -n '__servoctl_at param' -a explain -d 'Tell all that is known of a panel parameter'
complete -c servoctl -n '__servoctl_in param explain' -x -a '(__servoctl_names parameters)'
complete -c servoctl -n __servoctl_at -a backup -d 'Save the settings of a drive into a file'
complete -c servoctl -n '__servoctl_in backup' -r -F
complete -c servoctl -n '__servoctl_in backup' -l only -x -d 'communication, pdo, params, or a group of parameters'
complete -c servoctl -n __servoctl_at -a diff -d 'Compare two backups, or one with the factory values'
complete -c servoctl -n '__servoctl_in diff' -r -F
complete -c servoctl -n '__servoctl_in diff' -r -F
complete -c servoctl -n __servoctl_at -a verify -d 'Compare a drive with a backup or the factory values'
complete -c servoctl -n '__servoctl_in verify' -r -F
complete -c servoctl -n __servoctl_at -a restore -d 'Put a backup into a drive: all of it or nothing'
complete -c servoctl -n '__servoctl_in restore' -r -F
complete -c servoctl -n '__servoctl_in restore' -l with-address -d 'node-ID and bitrate as well'
complete -c servoctl -n '__servoctl_in restore' -l no-rollback -d 'leave things as they are when a write fails'
complete -c servoctl -n '__servoctl_in restore' -l force -d 'although identity or family are others'
complete -c servoctl -n '__servoctl_in restore' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in restore' -l unlock -d 'give the family'\''s password before, take it back after'
complete -c servoctl -n '__servoctl_in restore' -l resume -d 'go on with what was cut off, as it was begun'
complete -c servoctl -n __servoctl_at -a clone -d 'Put the settings of one drive into others'
complete -c servoctl -n '__servoctl_in clone' -l from -x -d 'node whose settings are taken'
complete -c servoctl -n '__servoctl_in clone' -l to -x -d 'nodes that get them: 2,3'
complete -c servoctl -n '__servoctl_in clone' -l force -d 'although identities differ'
complete -c servoctl -n '__servoctl_in clone' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in clone' -l unlock -d 'give the family'\''s password before, take it back after'
complete -c servoctl -n '__servoctl_in clone' -l resume -d 'go on with what was cut off, as it was begun'
complete -c servoctl -n __servoctl_at -a store -d 'Make a drive keep its present values'
complete -c servoctl -n '__servoctl_in store' -x -a 'all communication application vendor'
complete -c servoctl -n __servoctl_at -a defaults -d 'Restore the factory values of a drive'
complete -c servoctl -n '__servoctl_in defaults' -x -a 'all communication application vendor'
complete -c servoctl -n '__servoctl_at fault' -a show -d 'Show what is wrong with a drive and what to do'
complete -c servoctl -n '__servoctl_at fault' -a list -d 'List the faults and warnings of a drive family'
complete -c servoctl -n '__servoctl_at fault' -a reset -d 'Reset the fault of a drive'
complete -c servoctl -n '__servoctl_at fault' -a clear-history -d 'Clear the fault history of a drive (1003h)'
complete -c servoctl -n '__servoctl_at nmt' -a start -d 'Put nodes into operational: PDOs flow'
complete -c servoctl -n '__servoctl_in nmt start' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a stop -d 'Put nodes into stopped: neither PDO nor SDO'
complete -c servoctl -n '__servoctl_in nmt stop' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a preop -d 'Put nodes into pre-operational: SDO, no PDO'
complete -c servoctl -n '__servoctl_in nmt preop' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a reset -d 'Restart nodes (reset node); asks first'
complete -c servoctl -n '__servoctl_in nmt reset' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a reset-comm -d 'Restart the communication of nodes; asks first'
complete -c servoctl -n '__servoctl_in nmt reset-comm' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a watch -d 'Watch whether nodes are alive: heartbeat or node guarding'
complete -c servoctl -n '__servoctl_in nmt watch' -l for -x -d 'how long; until Ctrl-C unless said'
complete -c servoctl -n '__servoctl_in nmt watch' -l guard -x -d 'ask by node guarding, once in this time'
complete -c servoctl -n '__servoctl_in nmt watch' -l life -x -d 'lost after so many guard times without answer (default 3)'
complete -c servoctl -n __servoctl_at -a decode -d 'Explain a recording: SDO with names and values, NMT, EMCY'
complete -c servoctl -n '__servoctl_in decode' -r -F
complete -c servoctl -n '__servoctl_in decode' -l raw -d 'show the frames as well'
complete -c servoctl -n __servoctl_at -a drives -d 'List the drive families servoctl knows, or the rules of one'
complete -c servoctl -n '__servoctl_in drives' -x -a '(servoctl completion families 2>/dev/null)'
complete -c servoctl -n '__servoctl_at eds' -a check -d 'Check EDS and DCF files against CiA 306'
complete -c servoctl -n '__servoctl_in eds check' -r -F
complete -c servoctl -n __servoctl_at -a run -d 'Run the command lines of a file'
complete -c servoctl -n '__servoctl_in run' -r -F
complete -c servoctl -n '__servoctl_in run' -l var -x -d 'NAME=VALUE: a variable of the file, over its own `set`; may be repeated'
complete -c servoctl -n '__servoctl_in run' -l check -d 'check all lines without a bus, run none'
complete -c servoctl -n __servoctl_at -a sim -d 'Put simulated drives on a bus until Ctrl-C'
complete -c servoctl -n __servoctl_at -a completion -d 'Print the completion script of a shell'
complete -c servoctl -n '__servoctl_in completion' -x -a 'bash zsh fish objects parameters families'
complete -c servoctl -n __servoctl_at -a help -d 'Show the commands, or how one is used'
complete -c servoctl -n '__servoctl_in help' -x -a 'scan info status read write objects param backup diff verify restore clone store defaults fault nmt decode drives eds run sim completion help'
complete -c servoctl -n __servoctl_at -a param
complete -c servoctl -n __servoctl_at -a fault
complete -c servoctl -n __servoctl_at -a nmt
complete -c servoctl -n __servoctl_at -a eds
