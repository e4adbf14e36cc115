#include "commands/command.hpp"

#include <algorithm>

#include "commands/output_form.hpp"

namespace servoctl::commands {

extern const Command kScan;
extern const Command kInfo;
extern const Command kStatus;
extern const Command kRead;
extern const Command kWrite;
extern const Command kObjects;
extern const Command kParamList;
extern const Command kParamGet;
extern const Command kParamSet;
extern const Command kParamSearch;
extern const Command kParamExplain;
extern const Command kBackup;
extern const Command kDiff;
extern const Command kVerify;
extern const Command kRestore;
extern const Command kClone;
extern const Command kStore;
extern const Command kDefaults;
extern const Command kFaultShow;
extern const Command kFaultList;
extern const Command kFaultReset;
extern const Command kFaultClearHistory;
extern const Command kEnable;
extern const Command kDisable;
extern const Command kQuickStopCommand;
extern const Command kMode;
extern const Command kJog;
extern const Command kMove;
extern const Command kHome;
extern const Command kTorque;
extern const Command kUnitsShow;
extern const Command kUnitsLearn;
extern const Command kUnitsForget;
extern const Command kNmtStart;
extern const Command kNmtStop;
extern const Command kNmtPreop;
extern const Command kNmtReset;
extern const Command kNmtResetComm;
extern const Command kNmtWatch;
extern const Command kPdoShow;
extern const Command kPdoMap;
extern const Command kPdoEnable;
extern const Command kPdoDisable;
extern const Command kPdoClear;
extern const Command kPdoPreset;
extern const Command kPdoApply;
extern const Command kPdoSave;
extern const Command kPdoWatch;
extern const Command kPdoSend;
extern const Command kTestComm;
extern const Command kTestIo;
extern const Command kTestJog;
extern const Command kTestHome;
extern const Command kTestAll;
extern const Command kReport;
extern const Command kSyncOnce;
extern const Command kSyncStart;
extern const Command kSyncStop;
extern const Command kWatch;
extern const Command kScope;
extern const Command kMonitor;
extern const Command kDecode;
extern const Command kReplay;
extern const Command kDrives;
extern const Command kEdsCheck;
extern const Command kRun;
extern const Command kSim;
extern const Command kHelp;
extern const Command kCompletion;

namespace {

constexpr std::string_view kLanguages[] = {"en", "zh"};

constexpr Parameter kGlobal[] = {
    {.name = "--bus",
     .help = "bus: can0, local:NAME, sim:gsd600@1 (default $SERVOCTL_BUS)",
     .kind = Kind::bus,
     .short_name = "-b"},
    {.name = "--node",
     .help = "node-ID, a list 1,3,5-8 or all (default $SERVOCTL_NODE)",
     .kind = Kind::nodes,
     .short_name = "-n"},
    {.name = "--drive",
     .help = "drive family or an .eds file (default $SERVOCTL_DRIVE)",
     .kind = Kind::family,
     .short_name = "-d"},
    {.name = "--timeout", .help = "longest wait for one answer (default 500ms)", .kind = Kind::duration},
    {.name = "--retries",
     .help = "further tries of a read without answer (default 1); a write is never repeated",
     .kind = Kind::number},
    {.name = "--json", .help = "one JSON document instead of text", .kind = Kind::flag},
    {.name = "--output",
     .help = "text, json, or jsonl for one document a sample",
     .kind = Kind::choice,
     .choices = kOutputForms,
     .short_name = "-o"},
    {.name = "--lang",
     .help = "language of names: en or zh (default $SERVOCTL_LANG)",
     .kind = Kind::choice,
     .choices = kLanguages},
    {.name = "--yes", .help = "answer yes to what would be asked", .kind = Kind::flag, .short_name = "-y"},
    {.name = "--force-family",
     .help = "go on although the identity of the drive contradicts -d; --yes never says so",
     .kind = Kind::flag},
    {.name = "--read-only", .help = "refuse everything that changes a drive", .kind = Kind::flag},
    {.name = "--dry-run", .help = "show the frames, send nothing that changes a drive", .kind = Kind::flag},
    {.name = "--trace", .help = "write every frame into a file (candump -L form)", .kind = Kind::file},
    {.name = "--help", .help = "show the help of the command", .kind = Kind::flag, .short_name = "-h"},
};

}  // namespace

std::span<const Command* const> registry() {
  static constexpr const Command* kAll[] = {
      &kScan,
      &kInfo,
      &kStatus,
      &kRead,
      &kWrite,
      &kObjects,
      &kParamList,
      &kParamGet,
      &kParamSet,
      &kParamSearch,
      &kParamExplain,
      &kBackup,
      &kDiff,
      &kVerify,
      &kRestore,
      &kClone,
      &kStore,
      &kDefaults,
      &kFaultShow,
      &kFaultList,
      &kFaultReset,
      &kFaultClearHistory,
      &kEnable,
      &kDisable,
      &kQuickStopCommand,
      &kMode,
      &kJog,
      &kMove,
      &kHome,
      &kTorque,
      &kUnitsShow,
      &kUnitsLearn,
      &kUnitsForget,
      &kNmtStart,
      &kNmtStop,
      &kNmtPreop,
      &kNmtReset,
      &kNmtResetComm,
      &kNmtWatch,
      &kPdoShow,
      &kPdoMap,
      &kPdoEnable,
      &kPdoDisable,
      &kPdoClear,
      &kPdoPreset,
      &kPdoApply,
      &kPdoSave,
      &kPdoWatch,
      &kPdoSend,
      &kTestComm,
      &kTestIo,
      &kTestJog,
      &kTestHome,
      &kTestAll,
      &kReport,
      &kSyncOnce,
      &kSyncStart,
      &kSyncStop,
      &kWatch,
      &kScope,
      &kMonitor,
      &kDecode,
      &kReplay,
      &kDrives,
      &kEdsCheck,
      &kRun,
      &kSim,
      &kHelp,
      &kCompletion,
  };
  return kAll;
}

const Command* find_command(std::string_view path) {
  const auto all = registry();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Command* c) { return c->path == path; });
  return found == all.end() ? nullptr : *found;
}

std::span<const Parameter> global_options() { return kGlobal; }

}  // namespace servoctl::commands
