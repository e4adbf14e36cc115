#include "command/man_page.hpp"

namespace servoctl::command {
namespace {

constexpr Entry kManualBuses[] = {
    {"can0", "SocketCAN: any adapter that the Linux kernel supports; `socketcan:can0` is the same."},
    {"slcan:/dev/ttyACM0@500k",
     "A serial adapter with the LAWICEL protocol (CANable, USBtin, CANUSB), without a driver. Behind the @ "
     "stands the bitrate of the bus, behind a comma the baud rate of a real serial line: "
     "`slcan:/dev/ttyUSB0@500k,57600`."},
    {"socketcand://192.168.7.2:29536/can0",
     "The CAN interface of another machine, by its socketcand. There is neither login nor encryption: for "
     "loopback and private networks only."},
    {"gateway://127.0.0.1:60000",
     "The bus behind a gateway of CiA 309-3, such as `servoctl gateway`; `gateway:/run/socket` is one with a "
     "local socket. Objects and NMT commands; no drive is energised over it."},
    {"coe:eth0",
     "CANopen over EtherCAT on an Ethernet port that has the drives on it and nothing else. It needs root, or "
     "the capability CAP_NET_RAW: `sudo setcap cap_net_raw+ep \"$(readlink -f \"$(command -v servoctl)\")\"`, "
     "again after each update. Whoever may start the program has that right then."},
    {"modbus:/dev/ttyUSB0@19200,8E1",
     "Modbus RTU, with `,ascii` behind it Modbus ASCII, and `modbus://HOST:502` Modbus TCP, for families "
     "whose data name registers: parameters and readings, no motion."},
    {"local:NAME", "A virtual bus between the processes of one machine and user, for kernels without CAN."},
    {"coe:local:NAME", "A virtual EtherCAT cable between two processes: `servoctl sim` is at its other end."},
    {"sim:gsd600@1,gsd600@2",
     "Drives simulated in this process; `sim:gsd600@1?state=FILE` keeps their memory in a file."},
    {"coe:sim:sv2@1", "An EtherCAT ring simulated in this process."},
    {"modbus:sim:ts@1", "Drives on Modbus simulated in this process."},
    {"replay:recording.log", "A recording that answers as its drives did."},
};

constexpr Entry kManualEnvironment[] = {
    {"SERVOCTL_BUS", "The bus where there is no `--bus`."},
    {"SERVOCTL_NODE", "The nodes where there is no `--node`."},
    {"SERVOCTL_DRIVE", "The family where there is no `--drive`."},
    {"SERVOCTL_CABINET", "The cabinet file where there is no `--cabinet`."},
    {"SERVOCTL_LANG",
     "The language of names where there is no `--lang`: `zh` is Chinese, anything else English. Where it is "
     "empty, the language is Chinese when `LANG` begins with zh."},
    {"SERVOCTL_PAGER",
     "The program that shows what is longer than the window of the terminal, as a shell takes it, where there "
     "is no `--no-pager`; where it is not set, `PAGER`, else `less -FRX` where there is less. None where it is "
     "empty or `cat`; nor for batch files, in a pipe, for JSON, for what comes bit by bit such as `watch`, and "
     "while a drive is energised. The bus is closed before it starts, and the exit code is that of the command. "
     "The prompt needs no program: it shows a window at a time itself, because the bus goes on meanwhile."},
    {"PAGER", "See `SERVOCTL_PAGER`."},
    {"LESS", "Where it is not set the pager gets `FRX`."},
    {"LESSCHARSET", "Where it is not set the pager gets `utf-8`."},
    {"PATH", "Where `less` and `man` are looked for."},
    {"SERVOCTL_DRIVES",
     "Folders with the data of drive families, separated by colons. They are looked through before those "
     "named in FILES."},
    {"XDG_CONFIG_HOME", "The folder for `servoctl/drives`, instead of `~/.config`."},
    {"XDG_STATE_HOME", "The folder for `servoctl`, instead of `~/.local/state`."},
    {"XDG_RUNTIME_DIR",
     "The folder for the sockets of `local:` buses, if it belongs to the user. Otherwise they are in "
     "`/run/user/UID/servoctl` or `/tmp/servoctl-UID`."},
    {"HOME", "Where `~` is."},
    {"SUDO_UID",
     "The user who started `sudo`. If servoctl runs as root under `sudo`, it also trusts files of this user."},
    {"LANG",
     "See `SERVOCTL_LANG`. Where it, `LC_CTYPE` or `LC_ALL` (the last has precedence) names a locale without "
     "UTF-8, such as C, English text is ASCII; JSON, and Chinese where it was asked for, stay UTF-8."},
    {"NO_COLOR",
     "Text has no colours where it is set and not empty, unless `--color always` says otherwise."},
    {"TERM", "Where it is empty or `dumb` the prompt has no line editor, and text no colours."},
    {"SOURCE_DATE_EPOCH",
     "Seconds since 1970 that stand for the present time in the files that are written, so that they can be "
     "made the same again."},
};

constexpr Entry kManualFiles[] = {
    {"cabinet.toml",
     "The axes by name and what their drives are to hold; found in the current folder or above it. A file of another "
     "user, or one that others can write, must be named (--cabinet)."},
    {"~/.config/servoctl/drives/",
     "Drive families of the user's own. Files of another user are used only where SERVOCTL_DRIVES names the "
     "folder."},
    {"PREFIX/share/servoctl/eds/",
     "The drive families that come with servoctl; PREFIX is the nearest folder above the program "
     "that has them: /usr for /usr/bin/servoctl."},
    {"~/.local/state/servoctl/",
     "What is remembered: the history of the prompt, the family and counts that were said of a drive, "
     "measured counts per revolution, and what the PDOs of a drive were while they are being changed."},
};

constexpr Entry kManualExamples[] = {
    {"servoctl bus up can0 --bitrate 500k", "Bring the interface up, as root or with CAP_NET_ADMIN."},
    {"servoctl scan -b can0", "Who is on the bus."},
    {"servoctl status -b can0 -n all", "The state of all drives, one line each."},
    {"servoctl fault show -b can0 -n 1 -d gsd600", "What is wrong with a drive and what to do."},
    {"servoctl param set Pn0214 45Hz -b can0 -n 1 -d gsd600",
     "Change a parameter by its number in the manual and read it back."},
    {"servoctl backup good.json -b can0 -n 1 -d gsd600", "Save the settings of a drive."},
    {"servoctl restore good.json -b can0 -n 1 -d gsd600 --dry-run", "Show what restoring them would write."},
    {"servoctl jog 60rpm --for 2s -b coe:eth0 -n 1 -d sv2",
     "Turn a motor for two seconds, after a question."},
    {"servoctl read 0x6041 -b can0 -n 1 --json", "An object for a script."},
    {"servoctl scan -b sim:gsd600@1,ts@2", "A scan without hardware: two simulated drives."},
};

}  // namespace

std::span<const Entry> manual_buses() { return kManualBuses; }
std::span<const Entry> manual_environment() { return kManualEnvironment; }
std::span<const Entry> manual_files() { return kManualFiles; }
std::span<const Entry> manual_examples() { return kManualExamples; }

}  // namespace servoctl::command
