#!/usr/bin/env bash
# Checks every #include against the table of layers: an arrow may only point down.
# usage: layering.sh SOURCE_DIR
set -euo pipefail
cd "$1"

# What each folder may include, itself not named.
declare -A may=(
  [base]=""
  [can]="base"
  [canopen]="base can"
  [ethercat]="base canopen"
  [ethernet]="base can"
  [modbus]="base can"
  [od]="base"
  [drive]="base od"
  [gateway]="base can canopen od"
  [report]="base"
  [sim]="base can canopen ethercat ethernet modbus od drive"
  [session]="base can canopen ethercat ethernet gateway modbus od drive sim"
  [show]="base can canopen ethercat od drive sim session report"
  [motion]="base can canopen od drive sim session report show"
  [settings]="base can canopen od drive sim session report show"
  [pdo]="base can canopen od drive sim session report show settings"
  [traffic]="base can canopen od drive sim session report show"
  [trial]="base can canopen od drive sim session report show motion settings pdo traffic"
  [cabinet]="base can canopen od drive sim session report show motion settings pdo"
  [command]="base can canopen od drive sim session report show motion settings pdo traffic trial cabinet"
  [commands]="base gateway can canopen od drive sim session report show motion settings pdo traffic trial cabinet command"
  [cli]="base gateway can canopen od drive sim session report show motion settings pdo traffic trial cabinet command commands"
  [main.cpp]="cli"
)
checked=0
bad=0
while IFS=: read -r file line text; do
  case "$file" in
    commands/*) layer=commands ;;
    src/main.cpp) layer=main.cpp ;;
    *) layer=${file#src/}; layer=${layer%%/*} ;;
  esac
  target=$(sed -E 's/.*"([a-z]+)\/.*/\1/' <<<"$text")
  checked=$((checked + 1))
  [ -n "${may[$layer]+set}" ] || { echo "$file: the folder is not in the table of layers"; bad=1; continue; }
  [ "$target" = "$layer" ] && continue
  [[ " ${may[$layer]} " == *" $target "* ]] || { echo "$file:$line: $layer must not include $target: $text"; bad=1; }
done < <(grep -rnE '^#include "[a-z]+/' src commands --include='*.cpp' --include='*.hpp')

# canopen knows frames, not buses: no I/O and no clock.
if grep -rnE '#include "can/(bus|socketcan|local|trace|descriptor)' src/canopen; then echo "canopen must know can/frame.hpp only"; bad=1; fi
if grep -rnE 'steady_now|steady_clock::now|system_clock' src/canopen src/od src/drive; then echo "no clock in these layers"; bad=1; fi
if grep -rnE 'steady_now|steady_clock::now|system_clock|#include <(sys|net|linux)/' src/ethercat; then echo "the machines of ethercat know no clock and no socket"; bad=1; fi

# What is in commands/ is a command, or the list of them.
for file in commands/*; do
  [ "$file" = commands/registry.cpp ] || grep -qE '^(const|constexpr) Command k' "$file" || { echo "$file defines no Command"; bad=1; }
done

# No room is most of the house.
lines_of() { find "$@" -name '*.?pp' -exec cat {} + | wc -l; }
all=$(lines_of src commands)
for room in src/*/ commands/; do
  lines=$(lines_of "$room")
  [ $((lines * 100)) -le $((all * 15)) ] || { echo "$room holds $lines of $all lines: more than 15 %"; bad=1; }
done

# A simulated drive is a model without a wire and ports around it: of canopen the model includes what knows no frame, of sim nothing
# that does. What is new in sim is the model's until it is named here.
wire='answer_way|can_port|cell|communication_guard|device|emergency_producer|esc_[a-z_]+|heartbeat_consumer|lss_slave|modbus_cell|modbus_port|modbus_unit|pdo_engine|pdo_guard|sim_bus|sim_drive|sim_port'
frameless='node_id|object_store|sdo_abort'
model=$(find src/sim -name '*.?pp' | grep -vE "/($wire)\.[ch]pp$")
grep -q 'drive_model\.hpp' <<<"$model" || { echo "src/sim/drive_model.hpp was not found: the check itself is broken"; bad=1; }
# shellcheck disable=SC2086  # Names of files without spaces.
if grep -nE "^#include \"(can/|canopen/|ethercat/|modbus/|sim/($wire)\.hpp)" $model | grep -vE "\"canopen/($frameless)\.hpp\""; then echo "the model of a simulated drive must know no wire"; bad=1; fi
for header in ${frameless//|/ }; do
  if grep -nE '^#include "(can|canopen)/' "src/canopen/$header.hpp"; then echo "canopen/$header.hpp must know no frame"; bad=1; fi
done

# What is done with a drive knows nodes, objects and states (session/network.hpp); frames only where it is named here.
frames='session/(can_network|can_object_channel|hearing|tpdo_values)\.hpp|can/|canopen/(frame|pdo|sdo_client|sdo_server|nmt|error_control)\.hpp'
allowed='motion/(producer_claim|watchdog)\.cpp|trial/(comm_trial|io_trial)\.cpp'
if grep -rnE "^#include \"($frames)" src/motion src/settings src/trial | grep -vE "$allowed"; then echo "frames above session/network.hpp"; bad=1; fi

# The heavy headers each stand in one file.
for header in 'boost/context/fiber.hpp' 'CLI/CLI.hpp' 'nlohmann/json.hpp' 'toml++/toml.h' 'pugixml.hpp'; do
  count=$(grep -rlF "<$header>" src commands | wc -l)
  [ "$count" -eq 1 ] || { echo "<$header> stands in $count files, it must stand in one"; bad=1; }
done
[ "$checked" -gt 100 ] || { echo "only $checked includes were found: the check itself is broken"; bad=1; }
echo "checked $checked includes"
exit "$bad"
