#include "command/registry.hpp"

#include <algorithm>

namespace servoctl {
namespace commands {

using command::Command;

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

}  // namespace commands

namespace command {

std::span<const Command* const> registry() {
  static constexpr const Command* kAll[] = {
      &commands::kScan,
      &commands::kInfo,
      &commands::kStatus,
      &commands::kRead,
      &commands::kWrite,
      &commands::kObjects,
      &commands::kParamList,
      &commands::kParamGet,
      &commands::kParamSet,
      &commands::kParamSearch,
      &commands::kParamExplain,
      &commands::kBackup,
      &commands::kDiff,
      &commands::kVerify,
      &commands::kRestore,
      &commands::kClone,
      &commands::kStore,
      &commands::kDefaults,
      &commands::kFaultShow,
      &commands::kFaultList,
      &commands::kFaultReset,
      &commands::kFaultClearHistory,
      &commands::kEnable,
      &commands::kDisable,
      &commands::kQuickStopCommand,
      &commands::kMode,
      &commands::kJog,
      &commands::kMove,
      &commands::kHome,
      &commands::kTorque,
      &commands::kUnitsShow,
      &commands::kUnitsLearn,
      &commands::kUnitsForget,
      &commands::kNmtStart,
      &commands::kNmtStop,
      &commands::kNmtPreop,
      &commands::kNmtReset,
      &commands::kNmtResetComm,
      &commands::kNmtWatch,
      &commands::kPdoShow,
      &commands::kPdoMap,
      &commands::kPdoEnable,
      &commands::kPdoDisable,
      &commands::kPdoClear,
      &commands::kPdoPreset,
      &commands::kPdoApply,
      &commands::kPdoSave,
      &commands::kPdoWatch,
      &commands::kPdoSend,
      &commands::kTestComm,
      &commands::kTestIo,
      &commands::kTestJog,
      &commands::kTestHome,
      &commands::kTestAll,
      &commands::kReport,
      &commands::kSyncOnce,
      &commands::kSyncStart,
      &commands::kSyncStop,
      &commands::kWatch,
      &commands::kScope,
      &commands::kMonitor,
      &commands::kDecode,
      &commands::kReplay,
      &commands::kDrives,
      &commands::kEdsCheck,
      &commands::kRun,
      &commands::kSim,
      &commands::kHelp,
      &commands::kCompletion,
  };
  return kAll;
}

const Command* find_command(std::string_view path) {
  const auto all = registry();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Command* c) { return c->path == path; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace command
}  // namespace servoctl
