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
        else if contains -- $word --bus -b --node -n --drive -d --cabinet --timeout --retries --output -o --lang --trace --bitrate --sample-point --restart-ms --txqueuelen --for --type --to --transfer --from --format --only --family --name --axis --backup --wait --plan --assign --patience --vendor --product --revision --serial --activate --turn --turns --accel --csv --limit --max-torque --max-following-error --window --master-node --speed --search --offset --within --nameplate --guard --life --inhibit --event --cob-id --sync-start --count --longest --junit --expect --tolerance --stop-within --repeat --spread --encoder --title --tests --period --counter --every --svg --service --object --var --listen --allow
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

function __servoctl_topics
    set -l drive (__servoctl_drive)
    if test -n "$drive"
        servoctl completion topics -d $drive 2>/dev/null
    else
        servoctl completion topics 2>/dev/null
    end
end

function __servoctl_buses
    for interface in /sys/class/net/*
        set -l type (cat $interface/type 2>/dev/null; or echo 0)
        test $type = 280; and basename $interface
        test $type = 1; and not test -e $interface/phy80211; and echo coe:(basename $interface)
    end
    echo sim:
    echo local:
    echo slcan:/dev/
    echo socketcand://
    echo gateway://
    echo coe:local:
    find /dev -maxdepth 1 \( -name 'ttyUSB*' -o -name 'ttyACM*' \) 2>/dev/null | sed 's|.*|slcan:&\nmodbus:&|'
    echo coe:sim:
    echo modbus:
    echo modbus:sim:
end

function __servoctl_sheets
    set -l typed (commandline -ct)
    for sheet in $typed*.eds $typed*.dcf $typed*.xml
        echo $sheet
    end
end

complete -c servoctl -f
complete -c servoctl -l bus -s b -x -a '(__servoctl_buses)' -d 'bus: can0, slcan:PORT@500k, socketcand://HOST/can0, local:NAME, sim:gsd600@1 (default $SERVOCTL_BUS)'
complete -c servoctl -l node -s n -x -a 'all' -d 'node-ID, a list 1,3,5-8, axes by name, or all (default $SERVOCTL_NODE)'
complete -c servoctl -l drive -s d -x -a '(servoctl completion families 2>/dev/null; __servoctl_sheets)' -d 'drive family, an .eds, .dcf or .xml file, or online: the drive itself (default $SERVOCTL_DRIVE)'
complete -c servoctl -l cabinet -r -F -d 'cabinet file: axes by name (default $SERVOCTL_CABINET, or cabinet.toml here or above)'
complete -c servoctl -l timeout -x -d 'longest wait for one answer (default 500ms)'
complete -c servoctl -l retries -x -d 'retries of an unanswered read (default 1); a write is never repeated'
complete -c servoctl -l json -d 'one JSON document instead of text'
complete -c servoctl -l output -s o -x -a 'text json jsonl' -d 'text, json, or jsonl for one document per sample'
complete -c servoctl -l lang -x -a 'en zh' -d 'language of names: en or zh (default $SERVOCTL_LANG)'
complete -c servoctl -l yes -s y -d 'answer yes to every question'
complete -c servoctl -l quiet -s q -d 'no notices and no progress on stderr; errors stay'
complete -c servoctl -l force-family -d 'continue although the drive'\''s identity contradicts -d; --yes does not imply it'
complete -c servoctl -l read-only -d 'refuse everything that changes a drive'
complete -c servoctl -l dry-run -d 'show the frames, send nothing that changes a drive'
complete -c servoctl -l trace -r -F -d 'write every frame to a file (candump -L format)'
complete -c servoctl -l help -s h -d 'show the help of the command'
complete -c servoctl -n __servoctl_at -a scan -d 'Find the nodes on the bus: what they are, and how'
complete -c servoctl -n '__servoctl_in scan' -l long -d 'the identity in numbers, instead of the drives'\'' state'
complete -c servoctl -n '__servoctl_in scan' -l all-bitrates -d 'ask at each bitrate in turn, where nobody talks; asks first'
complete -c servoctl -n '__servoctl_at bus' -a status -d 'Show the CAN interfaces: bitrate, state, error counters'
complete -c servoctl -n '__servoctl_in bus status' -x -a '(__servoctl_buses)'
complete -c servoctl -n '__servoctl_at bus' -a up -d 'Bring a CAN interface up with a bitrate'
complete -c servoctl -n '__servoctl_in bus up' -x -a '(__servoctl_buses)'
complete -c servoctl -n '__servoctl_in bus up' -l bitrate -x -d 'bitrate of the drives: 125k, 250k, 500k, 1M'
complete -c servoctl -n '__servoctl_in bus up' -l sample-point -x -d 'where in a bit it is sampled: 0.8 or 80%'
complete -c servoctl -n '__servoctl_in bus up' -l restart-ms -x -d 'come back so long after a bus-off; 0: never'
complete -c servoctl -n '__servoctl_in bus up' -l txqueuelen -x -d 'frames that may wait to be sent: 1000'
complete -c servoctl -n '__servoctl_at bus' -a down -d 'Take a CAN interface down'
complete -c servoctl -n '__servoctl_in bus down' -x -a '(__servoctl_buses)'
complete -c servoctl -n '__servoctl_at bus' -a detect -d 'Find the bitrate of a bus by listening'
complete -c servoctl -n '__servoctl_in bus detect' -x -a '(__servoctl_buses)'
complete -c servoctl -n '__servoctl_in bus detect' -l for -x -d 'how long to listen at each bitrate (default 2s)'
complete -c servoctl -n '__servoctl_in bus detect' -l bitrate -x -d 'listen at this bitrate only; may be given several times (default: those of CiA 301, and 100k)'
complete -c servoctl -n __servoctl_at -a doctor -d 'Say what is wrong with a bus, and what mends it'
complete -c servoctl -n '__servoctl_in doctor' -x -a '(__servoctl_buses)'
complete -c servoctl -n '__servoctl_in doctor' -l active -d 'also ask all nodes for 1000h'
complete -c servoctl -n '__servoctl_in doctor' -l for -x -d 'how long to listen to each (default 2s)'
complete -c servoctl -n __servoctl_at -a info -d 'Show the identity of a node'
complete -c servoctl -n __servoctl_at -a status -d 'Show the state of drives, one line each: NMT or AL, CiA 402, mode, fault'
complete -c servoctl -n '__servoctl_in status' -l long -d 'every bit of the statusword, and more, in several lines a node'
complete -c servoctl -n __servoctl_at -a read -d 'Read objects of a node'
complete -c servoctl -n '__servoctl_in read' -x -a '(__servoctl_names objects)'
complete -c servoctl -n '__servoctl_in read' -l type -x -a 'bool i8 i16 i24 i32 i64 u8 u16 u24 u32 u64 f32 f64 string bytes domain' -d 'data type, if the dictionary does not have it'
complete -c servoctl -n '__servoctl_in read' -l to -r -F -d 'write the bytes of one object to this file'
complete -c servoctl -n '__servoctl_in read' -l transfer -x -a 'auto expedited segmented block' -d 'SDO transfer type (default: chosen by size)'
complete -c servoctl -n __servoctl_at -a write -d 'Write one object of a node'
complete -c servoctl -n '__servoctl_in write' -x -a '(__servoctl_names objects)'
complete -c servoctl -n '__servoctl_in write' -l type -x -a 'bool i8 i16 i24 i32 i64 u8 u16 u24 u32 u64 f32 f64 string bytes domain' -d 'data type, if the dictionary does not have it'
complete -c servoctl -n '__servoctl_in write' -l from -r -F -d 'write the bytes of this file instead of a value'
complete -c servoctl -n '__servoctl_in write' -l transfer -x -a 'auto expedited segmented block' -d 'SDO transfer type (default: chosen by size)'
complete -c servoctl -n '__servoctl_in write' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in write' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n __servoctl_at -a explain -d 'Say what a word means: object, fault, code, plug, LED, mode, homing method'
complete -c servoctl -n '__servoctl_in explain' -x -a '(__servoctl_topics)'
complete -c servoctl -n __servoctl_at -a objects -d 'List the object dictionary of a drive family'
complete -c servoctl -n '__servoctl_at param' -a list -d 'List the panel parameters of a drive family'
complete -c servoctl -n '__servoctl_at param' -a get -d 'Read panel parameters of a drive'
complete -c servoctl -n '__servoctl_in param get' -x -a '(__servoctl_names parameters)'
complete -c servoctl -n '__servoctl_at param' -a set -d 'Change panel parameters of a drive and read them back'
complete -c servoctl -n '__servoctl_in param set' -x -a '(__servoctl_names parameters)'
complete -c servoctl -n '__servoctl_in param set' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in param set' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at param' -a search -d 'Find panel parameters by words, in English or Chinese'
complete -c servoctl -n '__servoctl_at param' -a explain -d 'Show all that is known about a panel parameter'
complete -c servoctl -n '__servoctl_in param explain' -x -a '(__servoctl_names parameters)'
complete -c servoctl -n __servoctl_at -a backup -d 'Save the settings of a drive to a file'
complete -c servoctl -n '__servoctl_in backup' -r -F
complete -c servoctl -n '__servoctl_in backup' -l format -x -a 'json dcf csv batch' -d 'json, dcf, csv or batch (default: by the file'\''s extension, else json)'
complete -c servoctl -n '__servoctl_in backup' -l only -x -d 'communication, pdo, params, changed (not at factory value), or a group of parameters'
complete -c servoctl -n '__servoctl_at cabinet' -a init -d 'Make a cabinet file from what is on the bus'
complete -c servoctl -n '__servoctl_in cabinet init' -r -F
complete -c servoctl -n '__servoctl_in cabinet init' -l family -x -d 'families of nodes: 1=gsd600,2-4=da200; without it they are guessed'
complete -c servoctl -n '__servoctl_in cabinet init' -l name -x -d 'name of the bus in the file (default main)'
complete -c servoctl -n '__servoctl_at cabinet' -a check -d 'Check a cabinet file without a bus'
complete -c servoctl -n '__servoctl_in cabinet check' -r -F
complete -c servoctl -n '__servoctl_at cabinet' -a show -d 'Show every axis of the cabinet, one line each'
complete -c servoctl -n '__servoctl_in cabinet show' -l watch -d 'look again and again, until q or Ctrl-C'
complete -c servoctl -n '__servoctl_in cabinet show' -l for -x -d 'how long (default: until Ctrl-C)'
complete -c servoctl -n '__servoctl_at cabinet' -a plan -d 'Show what differs between the cabinet file and the drives'
complete -c servoctl -n '__servoctl_in cabinet plan' -l axis -x -d 'these axes or groups only: feeder,lift (default: all)'
complete -c servoctl -n '__servoctl_in cabinet plan' -l only -x -d 'communication, pdo, params, or a group of parameters'
complete -c servoctl -n '__servoctl_in cabinet plan' -l no-unlisted -d 'do not read what is not in the file'
complete -c servoctl -n '__servoctl_at cabinet' -a apply -d 'Make the drives hold what the cabinet file says'
complete -c servoctl -n '__servoctl_in cabinet apply' -l axis -x -d 'these axes or groups only: feeder,lift (default: all)'
complete -c servoctl -n '__servoctl_in cabinet apply' -l only -x -d 'communication, pdo, params, or a group of parameters'
complete -c servoctl -n '__servoctl_in cabinet apply' -l no-keep -d 'write working values only; lost at power-off'
complete -c servoctl -n '__servoctl_in cabinet apply' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_in cabinet apply' -l all-or-nothing -d 'if one axis fails, put all back'
complete -c servoctl -n '__servoctl_in cabinet apply' -l resume -d 'resume the axes whose apply was interrupted'
complete -c servoctl -n '__servoctl_at cabinet' -a backup -d 'Save the settings of all axes to a dated folder'
complete -c servoctl -n '__servoctl_in cabinet backup' -l axis -x -d 'these axes or groups only: feeder,lift (default: all)'
complete -c servoctl -n '__servoctl_at cabinet' -a swap -d 'Put a new drive into the place of an axis'
complete -c servoctl -n '__servoctl_in cabinet swap' -l from -x -d 'node at which the new drive is, often 1'
complete -c servoctl -n '__servoctl_in cabinet swap' -l backup -r -F -d 'restore all of this folder of `cabinet backup`'
complete -c servoctl -n '__servoctl_in cabinet swap' -l wait -x -d 'how long to wait for a drive that is to be switched off and on'
complete -c servoctl -n '__servoctl_in cabinet swap' -l no-keep -d 'write working values only; lost at power-off'
complete -c servoctl -n '__servoctl_in cabinet swap' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_in cabinet swap' -l resume -d 'resume what was interrupted while settings were written'
complete -c servoctl -n '__servoctl_at cabinet' -a diff -d 'Compare two cabinet files, or backups of all axes'
complete -c servoctl -n '__servoctl_in cabinet diff' -r -F
complete -c servoctl -n '__servoctl_in cabinet diff' -r -F
complete -c servoctl -n __servoctl_at -a diff -d 'Compare backups, drives, factory values and data sheets'
complete -c servoctl -n '__servoctl_in diff' -r -F
complete -c servoctl -n '__servoctl_in diff' -r -F
complete -c servoctl -n '__servoctl_in diff' -l batch -d 'the command lines that turn A into B'
complete -c servoctl -n '__servoctl_in diff' -l skip-invalid -d 'skip entries that cannot be used, and list them'
complete -c servoctl -n __servoctl_at -a verify -d 'Compare a drive with a backup or the factory values'
complete -c servoctl -n '__servoctl_in verify' -r -F
complete -c servoctl -n '__servoctl_in verify' -l skip-invalid -d 'skip entries that cannot be used, and list them'
complete -c servoctl -n __servoctl_at -a restore -d 'Restore a backup to a drive: all of it or nothing'
complete -c servoctl -n '__servoctl_in restore' -r -F
complete -c servoctl -n '__servoctl_in restore' -l only -x -d 'communication, pdo, params, or a group of parameters'
complete -c servoctl -n '__servoctl_in restore' -l with-address -d 'node-ID and bitrate as well'
complete -c servoctl -n '__servoctl_in restore' -l no-rollback -d 'leave things as they are when a write fails'
complete -c servoctl -n '__servoctl_in restore' -l force -d 'even if identity or family differ'
complete -c servoctl -n '__servoctl_in restore' -l skip-invalid -d 'skip entries that cannot be used, and list them'
complete -c servoctl -n '__servoctl_in restore' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in restore' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_in restore' -l resume -d 'resume an interrupted run, same options'
complete -c servoctl -n __servoctl_at -a clone -d 'Copy the settings of one drive to others'
complete -c servoctl -n '__servoctl_in clone' -l from -x -d 'node whose settings are taken'
complete -c servoctl -n '__servoctl_in clone' -l to -x -d 'nodes that get them: 2,3,5-8'
complete -c servoctl -n '__servoctl_in clone' -l force -d 'even if identities differ'
complete -c servoctl -n '__servoctl_in clone' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in clone' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_in clone' -l resume -d 'resume an interrupted run, same options'
complete -c servoctl -n __servoctl_at -a address -d 'Give a drive another node-ID or bitrate; asks first'
complete -c servoctl -n '__servoctl_in address' -l bitrate -x -d 'the new bitrate: 125k, 250k, 500k, 1M'
complete -c servoctl -n '__servoctl_in address' -l plan -r -F -d 'renumber several: a CSV file with node,new (serial,bitrate)'
complete -c servoctl -n '__servoctl_in address' -l wait -x -d 'how long to wait for a drive that is to be switched off and on'
complete -c servoctl -n '__servoctl_in address' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_in address' -l resume -d 'resume an interrupted plan'
complete -c servoctl -n '__servoctl_at lss' -a scan -d 'Find LSS slaves without a node-ID; --assign gives them one'
complete -c servoctl -n '__servoctl_in lss scan' -l assign -x -d 'give them node-IDs in turn, from this one on; asks first'
complete -c servoctl -n '__servoctl_in lss scan' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in lss scan' -l patience -x -d 'longest wait for one answer (default 50ms)'
complete -c servoctl -n '__servoctl_in lss scan' -l vendor -x -d 'vendor-ID of the slave (1018h:01), such as 0x319'
complete -c servoctl -n '__servoctl_in lss scan' -l product -x -d 'its product code (1018h:02)'
complete -c servoctl -n '__servoctl_in lss scan' -l revision -x -d 'its revision number (1018h:03)'
complete -c servoctl -n '__servoctl_in lss scan' -l serial -x -d 'its serial number (1018h:04)'
complete -c servoctl -n '__servoctl_at lss' -a inquire -d 'Ask one LSS slave what it is, and for its node-ID'
complete -c servoctl -n '__servoctl_in lss inquire' -l vendor -x -d 'vendor-ID of the slave (1018h:01), such as 0x319'
complete -c servoctl -n '__servoctl_in lss inquire' -l product -x -d 'its product code (1018h:02)'
complete -c servoctl -n '__servoctl_in lss inquire' -l revision -x -d 'its revision number (1018h:03)'
complete -c servoctl -n '__servoctl_in lss inquire' -l serial -x -d 'its serial number (1018h:04)'
complete -c servoctl -n '__servoctl_in lss inquire' -l only -d 'the only LSS slave on the bus, whoever it is'
complete -c servoctl -n '__servoctl_at lss' -a set-node -d 'Give an LSS slave a node-ID; asks first'
complete -c servoctl -n '__servoctl_in lss set-node' -l vendor -x -d 'vendor-ID of the slave (1018h:01), such as 0x319'
complete -c servoctl -n '__servoctl_in lss set-node' -l product -x -d 'its product code (1018h:02)'
complete -c servoctl -n '__servoctl_in lss set-node' -l revision -x -d 'its revision number (1018h:03)'
complete -c servoctl -n '__servoctl_in lss set-node' -l serial -x -d 'its serial number (1018h:04)'
complete -c servoctl -n '__servoctl_in lss set-node' -l only -d 'the only LSS slave on the bus, whoever it is'
complete -c servoctl -n '__servoctl_in lss set-node' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_at lss' -a set-bitrate -d 'Set the bitrate of LSS slaves; asks first'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l activate -x -d 'all change after this time, such as 2s'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l all -d 'every LSS slave on the bus'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l vendor -x -d 'vendor-ID of the slave (1018h:01), such as 0x319'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l product -x -d 'its product code (1018h:02)'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l revision -x -d 'its revision number (1018h:03)'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l serial -x -d 'its serial number (1018h:04)'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l only -d 'the only LSS slave on the bus, whoever it is'
complete -c servoctl -n '__servoctl_in lss set-bitrate' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_at lss' -a store -d 'Let an LSS slave keep its node-ID and bitrate; asks first'
complete -c servoctl -n '__servoctl_in lss store' -l vendor -x -d 'vendor-ID of the slave (1018h:01), such as 0x319'
complete -c servoctl -n '__servoctl_in lss store' -l product -x -d 'its product code (1018h:02)'
complete -c servoctl -n '__servoctl_in lss store' -l revision -x -d 'its revision number (1018h:03)'
complete -c servoctl -n '__servoctl_in lss store' -l serial -x -d 'its serial number (1018h:04)'
complete -c servoctl -n '__servoctl_in lss store' -l only -d 'the only LSS slave on the bus, whoever it is'
complete -c servoctl -n __servoctl_at -a store -d 'Store the present values in the drive'
complete -c servoctl -n '__servoctl_in store' -x -a 'all communication application vendor'
complete -c servoctl -n __servoctl_at -a defaults -d 'Restore the factory values of a drive'
complete -c servoctl -n '__servoctl_in defaults' -x -a 'all communication application vendor'
complete -c servoctl -n '__servoctl_at fault' -a show -d 'Show what is wrong with a drive and what to do'
complete -c servoctl -n '__servoctl_at fault' -a list -d 'List the faults and warnings of a drive family'
complete -c servoctl -n '__servoctl_at fault' -a reset -d 'Reset the fault of a drive'
complete -c servoctl -n '__servoctl_at fault' -a clear-history -d 'Clear the fault history of a drive (1003h)'
complete -c servoctl -n __servoctl_at -a enable -d 'Energise a drive and leave it enabled'
complete -c servoctl -n '__servoctl_in enable' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n __servoctl_at -a disable -d 'De-energise (disable) a drive'
complete -c servoctl -n __servoctl_at -a quick-stop -d 'Stop a motor by quick stop'
complete -c servoctl -n __servoctl_at -a mode -d 'Show or set the mode of operation (6060h)'
complete -c servoctl -n __servoctl_at -a jog -d 'Turn a motor at a speed, for a time, some turns, or while a key is held'
complete -c servoctl -n '__servoctl_in jog' -l for -x -d 'how long'
complete -c servoctl -n '__servoctl_in jog' -l turns -x -d 'how many motor revolutions'
complete -c servoctl -n '__servoctl_in jog' -l until-key -d 'while an arrow key is held; any other key, or 5 s without one, ends it (default on a terminal)'
complete -c servoctl -n '__servoctl_in jog' -l accel -x -d 'ramps (6083h, 6084h); default: 0.5 s to speed'
complete -c servoctl -n '__servoctl_in jog' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_in jog' -l limit -x -d 'speed limit; raises the safe default'
complete -c servoctl -n '__servoctl_in jog' -l max-torque -x -d 'stop above this torque; for `torque`, the limit'
complete -c servoctl -n '__servoctl_in jog' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in jog' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in jog' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_in jog' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in jog' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n __servoctl_at -a move -d 'Go to a position'
complete -c servoctl -n '__servoctl_in move' -l relative -d 'relative to the actual position'
complete -c servoctl -n '__servoctl_in move' -l speed -x -d 'speed of the move (default: a fifth of the speed limit)'
complete -c servoctl -n '__servoctl_in move' -l accel -x -d 'ramps (6083h, 6084h); default: 0.5 s to speed'
complete -c servoctl -n '__servoctl_in move' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_in move' -l limit -x -d 'speed limit; raises the safe default'
complete -c servoctl -n '__servoctl_in move' -l max-torque -x -d 'stop above this torque; for `torque`, the limit'
complete -c servoctl -n '__servoctl_in move' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in move' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in move' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_in move' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in move' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n __servoctl_at -a home -d 'Find the home position'
complete -c servoctl -n '__servoctl_in home' -l speed -x -d 'switch search speed (6099h:01)'
complete -c servoctl -n '__servoctl_in home' -l search -x -d 'speed of the search for zero (6099h:02)'
complete -c servoctl -n '__servoctl_in home' -l offset -x -d 'home offset (607Ch)'
complete -c servoctl -n '__servoctl_in home' -l within -x -d 'timeout (default: from --window and speed, else 60s)'
complete -c servoctl -n '__servoctl_in home' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_in home' -l limit -x -d 'speed limit; raises the safe default'
complete -c servoctl -n '__servoctl_in home' -l max-torque -x -d 'stop above this torque; for `torque`, the limit'
complete -c servoctl -n '__servoctl_in home' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in home' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in home' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_in home' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in home' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n __servoctl_at -a torque -d 'Apply a torque for a time'
complete -c servoctl -n '__servoctl_in torque' -l for -x -d 'how long'
complete -c servoctl -n '__servoctl_in torque' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_in torque' -l limit -x -d 'speed limit; raises the safe default'
complete -c servoctl -n '__servoctl_in torque' -l max-torque -x -d 'stop above this torque; for `torque`, the limit'
complete -c servoctl -n '__servoctl_in torque' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in torque' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in torque' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_in torque' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in torque' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n '__servoctl_at units' -a show -d 'Show counts per revolution and rated torque, and their source'
complete -c servoctl -n '__servoctl_in units show' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_at units' -a learn -d 'Turn a motor slowly to measure its counts per revolution, and keep them'
complete -c servoctl -n '__servoctl_in units learn' -l speed -x -d 'motor speed: 15rpm to 30rpm (default 30rpm); the sign is the direction'
complete -c servoctl -n '__servoctl_in units learn' -l for -x -d 'measuring time (default 6s)'
complete -c servoctl -n '__servoctl_in units learn' -l nameplate -x -d 'encoder counts per revolution on the nameplate, compared with the result'
complete -c servoctl -n '__servoctl_in units learn' -l max-torque -x -d 'stop above this torque'
complete -c servoctl -n '__servoctl_in units learn' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in units learn' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in units learn' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in units learn' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n '__servoctl_in units learn' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_at units' -a forget -d 'Delete the kept counts per revolution'
complete -c servoctl -n '__servoctl_at heartbeat' -a set -d 'Let drives send a heartbeat (1017h)'
complete -c servoctl -n '__servoctl_in heartbeat set' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in heartbeat set' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at heartbeat' -a consume -d 'Let drives watch the heartbeat of a node (1016h)'
complete -c servoctl -n '__servoctl_in heartbeat consume' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in heartbeat consume' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at heartbeat' -a show -d 'Show who sends heartbeats, and who watches whom'
complete -c servoctl -n __servoctl_at -a watchdog -d 'Show what drives do when their master disappears'
complete -c servoctl -n '__servoctl_at nmt' -a start -d 'Set nodes to operational: PDOs active'
complete -c servoctl -n '__servoctl_in nmt start' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a stop -d 'Set nodes to stopped: no PDO, no SDO'
complete -c servoctl -n '__servoctl_in nmt stop' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a preop -d 'Set nodes to pre-operational: SDO, no PDO'
complete -c servoctl -n '__servoctl_in nmt preop' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a reset -d 'Restart nodes (NMT reset node); asks first'
complete -c servoctl -n '__servoctl_in nmt reset' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a reset-comm -d 'Reset communication of nodes (NMT); asks first'
complete -c servoctl -n '__servoctl_in nmt reset-comm' -l wait -d 'wait until a heartbeat or the boot-up message confirms it'
complete -c servoctl -n '__servoctl_at nmt' -a watch -d 'Watch whether nodes are alive: heartbeat or node guarding'
complete -c servoctl -n '__servoctl_in nmt watch' -l for -x -d 'how long (default: until Ctrl-C)'
complete -c servoctl -n '__servoctl_in nmt watch' -l guard -x -d 'use node guarding, with this guard time'
complete -c servoctl -n '__servoctl_in nmt watch' -l life -x -d 'life time factor: guard times without answer (default 3)'
complete -c servoctl -n '__servoctl_at state' -a init -d 'Set EtherCAT slaves to INIT: no objects, no process data'
complete -c servoctl -n '__servoctl_in state init' -l take-over -d 'take slaves that another master has left in SAFE-OP or OP; asks first'
complete -c servoctl -n '__servoctl_at state' -a preop -d 'Set EtherCAT slaves to PRE-OP: objects, no process data'
complete -c servoctl -n '__servoctl_in state preop' -l take-over -d 'take slaves that another master has left in SAFE-OP or OP; asks first'
complete -c servoctl -n '__servoctl_at state' -a safeop -d 'Set EtherCAT slaves to SAFE-OP: inputs only; holds it'
complete -c servoctl -n '__servoctl_in state safeop' -l take-over -d 'take slaves that another master has left in SAFE-OP or OP; asks first'
complete -c servoctl -n '__servoctl_at state' -a op -d 'Set EtherCAT slaves to OP: process data; holds it'
complete -c servoctl -n '__servoctl_in state op' -l take-over -d 'take slaves that another master has left in SAFE-OP or OP; asks first'
complete -c servoctl -n '__servoctl_at pdo' -a show -d 'Show what a drive sends and receives as PDOs'
complete -c servoctl -n '__servoctl_at pdo' -a map -d 'Set what a PDO carries, and when'
complete -c servoctl -n '__servoctl_in pdo map' -x -a '(__servoctl_names objects)'
complete -c servoctl -n '__servoctl_in pdo map' -l type -x -d 'transmission type: 1 at every SYNC, 255 by event'
complete -c servoctl -n '__servoctl_in pdo map' -l inhibit -x -d 'inhibit time: 10ms'
complete -c servoctl -n '__servoctl_in pdo map' -l event -x -d 'event timer, if the type uses it: 100ms'
complete -c servoctl -n '__servoctl_in pdo map' -l cob-id -x -d 'CAN-ID: 0x181, $NODEID+0x180; 29 bits: 0x1ABCDEF'
complete -c servoctl -n '__servoctl_in pdo map' -l sync-start -x -d 'SYNC start value (counter)'
complete -c servoctl -n '__servoctl_in pdo map' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in pdo map' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at pdo' -a enable -d 'Switch PDOs on'
complete -c servoctl -n '__servoctl_in pdo enable' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in pdo enable' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at pdo' -a disable -d 'Switch PDOs off'
complete -c servoctl -n '__servoctl_in pdo disable' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in pdo disable' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at pdo' -a clear -d 'Switch PDOs off, clear mapping'
complete -c servoctl -n '__servoctl_in pdo clear' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in pdo clear' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at pdo' -a preset -d 'Map the PDOs as the manual recommends for a mode'
complete -c servoctl -n '__servoctl_in pdo preset' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in pdo preset' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at pdo' -a apply -d 'Write the PDOs of a file to a drive'
complete -c servoctl -n '__servoctl_in pdo apply' -r -F
complete -c servoctl -n '__servoctl_in pdo apply' -l keep -d 'make the values survive power-off'
complete -c servoctl -n '__servoctl_in pdo apply' -l unlock -d 'unlock by the family'\''s password, lock again after'
complete -c servoctl -n '__servoctl_at pdo' -a save -d 'Save the PDOs of a drive to a file'
complete -c servoctl -n '__servoctl_in pdo save' -r -F
complete -c servoctl -n '__servoctl_at pdo' -a watch -d 'Show PDOs as they arrive, decoded by the drive'\''s mapping'
complete -c servoctl -n '__servoctl_in pdo watch' -l for -x -d 'how long (default: until Ctrl-C)'
complete -c servoctl -n '__servoctl_at pdo' -a send -d 'Send an RPDO once with these values; asks first'
complete -c servoctl -n '__servoctl_at test' -a comm -d 'Test the communication with a drive, with a verdict'
complete -c servoctl -n '__servoctl_in test comm' -l count -x -d 'reads to make (default 200)'
complete -c servoctl -n '__servoctl_in test comm' -l longest -x -d 'longest round trip that passes (default 100ms)'
complete -c servoctl -n '__servoctl_in test comm' -l junit -r -F -d 'write the verdicts to a file as JUnit XML'
complete -c servoctl -n '__servoctl_at test' -a io -d 'Watch the inputs of a drive while you actuate them, with a verdict'
complete -c servoctl -n '__servoctl_in test io' -l expect -x -d 'inputs that must be seen at 0 and at 1: negative-limit, positive-limit, home, bit16, …'
complete -c servoctl -n '__servoctl_in test io' -l for -x -d 'longest wait for them (default 30s)'
complete -c servoctl -n '__servoctl_in test io' -l junit -r -F -d 'write the verdicts to a file as JUnit XML'
complete -c servoctl -n '__servoctl_at test' -a jog -d 'Turn a motor both ways, with a verdict'
complete -c servoctl -n '__servoctl_in test jog' -l for -x -d 'how long in each direction (default 2s)'
complete -c servoctl -n '__servoctl_in test jog' -l tolerance -x -d 'how far the speed may be off, in % (default 10)'
complete -c servoctl -n '__servoctl_in test jog' -l stop-within -x -d 'longest time to standstill (default 1s)'
complete -c servoctl -n '__servoctl_in test jog' -l accel -x -d 'ramps (6083h, 6084h); default: 0.5 s to speed'
complete -c servoctl -n '__servoctl_in test jog' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_in test jog' -l junit -r -F -d 'write the verdicts to a file as JUnit XML'
complete -c servoctl -n '__servoctl_in test jog' -l limit -x -d 'speed limit; raises the safe default'
complete -c servoctl -n '__servoctl_in test jog' -l max-torque -x -d 'stop above this torque; for `torque`, the limit'
complete -c servoctl -n '__servoctl_in test jog' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in test jog' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in test jog' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_in test jog' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in test jog' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n '__servoctl_at test' -a home -d 'Home an axis several times, with a verdict'
complete -c servoctl -n '__servoctl_in test home' -l repeat -x -d 'runs (default 5)'
complete -c servoctl -n '__servoctl_in test home' -l spread -x -d 'greatest spread that passes, in the unit of the position (default 1)'
complete -c servoctl -n '__servoctl_in test home' -l encoder -x -d 'encoder counts per motor revolution, if the drive does not report them'
complete -c servoctl -n '__servoctl_in test home' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_in test home' -l junit -r -F -d 'write the verdicts to a file as JUnit XML'
complete -c servoctl -n '__servoctl_in test home' -l limit -x -d 'speed limit; raises the safe default'
complete -c servoctl -n '__servoctl_in test home' -l max-torque -x -d 'stop above this torque; for `torque`, the limit'
complete -c servoctl -n '__servoctl_in test home' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in test home' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in test home' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_in test home' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in test home' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n '__servoctl_at test' -a all -d 'Test communication, inputs, both directions and homing, with a verdict'
complete -c servoctl -n '__servoctl_in test all' -l expect -x -d 'inputs for `test io`; without it, no `test io`'
complete -c servoctl -n '__servoctl_in test all' -l for -x -d 'how long in each direction (default 2s)'
complete -c servoctl -n '__servoctl_in test all' -l tolerance -x -d 'how far the speed may be off, in % (default 10)'
complete -c servoctl -n '__servoctl_in test all' -l stop-within -x -d 'longest time to standstill (default 1s)'
complete -c servoctl -n '__servoctl_in test all' -l no-home -d 'skip `test home`'
complete -c servoctl -n '__servoctl_in test all' -l repeat -x -d 'homings (default 5)'
complete -c servoctl -n '__servoctl_in test all' -l spread -x -d 'greatest spread of home (default 1)'
complete -c servoctl -n '__servoctl_in test all' -l encoder -x -d 'encoder counts per motor revolution, if the drive does not report them'
complete -c servoctl -n '__servoctl_in test all' -l accel -x -d 'ramps (6083h, 6084h); default: 0.5 s to speed'
complete -c servoctl -n '__servoctl_in test all' -l junit -r -F -d 'write the verdicts to a file as JUnit XML'
complete -c servoctl -n '__servoctl_in test all' -l limit -x -d 'speed limit; raises the safe default'
complete -c servoctl -n '__servoctl_in test all' -l max-torque -x -d 'stop above this torque; for `torque`, the limit'
complete -c servoctl -n '__servoctl_in test all' -l max-following-error -x -d 'stop above this following error'
complete -c servoctl -n '__servoctl_in test all' -l window -x -d 'stop when it has moved further than this'
complete -c servoctl -n '__servoctl_in test all' -l turn -x -d 'increments of 6064h per motor revolution, if the drive does not report it'
complete -c servoctl -n '__servoctl_in test all' -l master-node -x -d 'node-ID of servoctl for the watchdog'
complete -c servoctl -n '__servoctl_in test all' -l plot -d 'plot the samples over time at the end'
complete -c servoctl -n __servoctl_at -a report -d 'Write a commissioning report: one page, or JSON'
complete -c servoctl -n '__servoctl_in report' -r -F
complete -c servoctl -n '__servoctl_in report' -l output -s o -r -F -d 'the file, like FILE; or the output format: text, json, jsonl'
complete -c servoctl -n '__servoctl_in report' -l title -x -d 'title of the report: the machine, the axis'
complete -c servoctl -n '__servoctl_in report' -l tests -r -F -d 'results of earlier tests (test … --json >FILE); may be repeated'
complete -c servoctl -n '__servoctl_at sync' -a once -d 'Send one SYNC; asks first'
complete -c servoctl -n '__servoctl_at sync' -a start -d 'Produce SYNC at a fixed period; asks first'
complete -c servoctl -n '__servoctl_in sync start' -l period -x -d 'SYNC period (default 10ms)'
complete -c servoctl -n '__servoctl_in sync start' -l counter -x -d 'with a counter from 1 to this overflow value (2..240, see 1019h)'
complete -c servoctl -n '__servoctl_in sync start' -l for -x -d 'how long (default: until Ctrl-C)'
complete -c servoctl -n '__servoctl_at sync' -a stop -d 'Stop the SYNC that `sync start` started'
complete -c servoctl -n __servoctl_at -a watch -d 'Show the values of objects over time'
complete -c servoctl -n '__servoctl_in watch' -x -a '(__servoctl_names objects)'
complete -c servoctl -n '__servoctl_in watch' -l every -x -d 'sampling period (default 100ms)'
complete -c servoctl -n '__servoctl_in watch' -l for -x -d 'how long (default: until Ctrl-C)'
complete -c servoctl -n '__servoctl_in watch' -l changes -d 'only when a value has changed'
complete -c servoctl -n '__servoctl_in watch' -l plot -d 'plot the values at the end'
complete -c servoctl -n __servoctl_at -a scope -d 'Record values of objects as fast as the bus allows'
complete -c servoctl -n '__servoctl_in scope' -x -a '(__servoctl_names objects)'
complete -c servoctl -n '__servoctl_in scope' -l for -x -d 'how long (default 2s)'
complete -c servoctl -n '__servoctl_in scope' -l map -d 'map them into an unused TPDO meanwhile'
complete -c servoctl -n '__servoctl_in scope' -l every -x -d 'period of that TPDO (default 1ms)'
complete -c servoctl -n '__servoctl_in scope' -l csv -r -F -d 'write the samples to this file'
complete -c servoctl -n '__servoctl_in scope' -l svg -r -F -d 'plot them to this file'
complete -c servoctl -n '__servoctl_in scope' -l plot -d 'plot them here'
complete -c servoctl -n __servoctl_at -a monitor -d 'Show everything on the bus as it happens, with names and values'
complete -c servoctl -n '__servoctl_in monitor' -l for -x -d 'how long (default: until Ctrl-C)'
complete -c servoctl -n '__servoctl_in monitor' -l service -x -a 'nmt sync time emcy pdo sdo boot-up heartbeat guarding lss controller other' -d 'only this service, such as sdo (may be given several times)'
complete -c servoctl -n '__servoctl_in monitor' -l object -x -a '(__servoctl_names objects)' -d 'only frames that carry or address this object'
complete -c servoctl -n '__servoctl_in monitor' -l ask -d 'first read the PDO mapping of the nodes given by -n'
complete -c servoctl -n '__servoctl_in monitor' -l bitrate -x -d 'bitrate for the bus load, if the interface does not give it: 500k'
complete -c servoctl -n '__servoctl_in monitor' -l table -d 'on a terminal: one row per CAN-ID, updated in place'
complete -c servoctl -n '__servoctl_in monitor' -l raw -d 'show the frames as well'
complete -c servoctl -n __servoctl_at -a decode -d 'Decode a recording: PDO and SDO with names and values, NMT, EMCY'
complete -c servoctl -n '__servoctl_in decode' -r -F
complete -c servoctl -n '__servoctl_in decode' -l raw -d 'show the frames as well'
complete -c servoctl -n '__servoctl_in decode' -l service -x -a 'nmt sync time emcy pdo sdo boot-up heartbeat guarding lss controller other' -d 'only this service, such as sdo (may be given several times)'
complete -c servoctl -n '__servoctl_in decode' -l object -x -a '(__servoctl_names objects)' -d 'only frames that carry or address this object'
complete -c servoctl -n __servoctl_at -a replay -d 'Send the frames of a recording again; asks first'
complete -c servoctl -n '__servoctl_in replay' -r -F
complete -c servoctl -n '__servoctl_in replay' -l speed -x -d '2 is twice as fast as recorded (default 1)'
complete -c servoctl -n '__servoctl_in replay' -l only -x -a 'nmt sync time emcy pdo sdo boot-up heartbeat guarding lss controller other' -d 'only this service, such as sdo (may be given several times)'
complete -c servoctl -n '__servoctl_in replay' -l master -d 'only what a master sends: NMT, SYNC, TIME, SDO requests, RPDOs'
complete -c servoctl -n __servoctl_at -a drives -d 'List the drive families servoctl knows, or the rules of one'
complete -c servoctl -n '__servoctl_in drives' -x -a '(servoctl completion families 2>/dev/null; __servoctl_sheets)'
complete -c servoctl -n '__servoctl_at eds' -a check -d 'Check EDS, DCF and ESI files'
complete -c servoctl -n '__servoctl_in eds check' -r -F
complete -c servoctl -n __servoctl_at -a run -d 'Run the command lines of a file'
complete -c servoctl -n '__servoctl_in run' -r -F
complete -c servoctl -n '__servoctl_in run' -l var -x -d 'NAME=VALUE: a variable, overrides `set` in the file; may be repeated'
complete -c servoctl -n '__servoctl_in run' -l frames -d 'with --dry-run: the frames of every line, for the present state of the drives'
complete -c servoctl -n '__servoctl_in run' -l check -d 'check all lines without a bus, run none'
complete -c servoctl -n __servoctl_at -a sim -d 'Put simulated drives on a bus until Ctrl-C'
complete -c servoctl -n __servoctl_at -a gateway -d 'Let clients of CiA 309-3, such as cocomm, use the bus until Ctrl-C'
complete -c servoctl -n '__servoctl_in gateway' -l listen -x -d '127.0.0.1:60000 (default), or a path such as /run/gateway for a local socket'
complete -c servoctl -n '__servoctl_in gateway' -l allow -x -a 'write' -d 'write: clients may write objects and send NMT commands; without it they only read'
complete -c servoctl -n __servoctl_at -a help -d 'Show the commands, or how one is used'
complete -c servoctl -n '__servoctl_in help' -x -a 'scan bus doctor info status read write explain objects param backup cabinet diff verify restore clone address lss store defaults fault enable disable quick-stop mode jog move home torque units heartbeat watchdog nmt state pdo test report sync watch scope monitor decode replay drives eds run sim gateway help man completion use drive undo log exit'
complete -c servoctl -n __servoctl_at -a man -d 'Print the manual page of servoctl'
complete -c servoctl -n __servoctl_at -a completion -d 'Print the completion script of a shell'
complete -c servoctl -n '__servoctl_in completion' -x -a 'bash zsh fish objects parameters topics families'
complete -c servoctl -n __servoctl_at -a bus
complete -c servoctl -n __servoctl_at -a param
complete -c servoctl -n __servoctl_at -a cabinet
complete -c servoctl -n __servoctl_at -a lss
complete -c servoctl -n __servoctl_at -a fault
complete -c servoctl -n __servoctl_at -a units
complete -c servoctl -n __servoctl_at -a heartbeat
complete -c servoctl -n __servoctl_at -a nmt
complete -c servoctl -n __servoctl_at -a state
complete -c servoctl -n __servoctl_at -a pdo
complete -c servoctl -n __servoctl_at -a test
complete -c servoctl -n __servoctl_at -a sync
complete -c servoctl -n __servoctl_at -a eds
