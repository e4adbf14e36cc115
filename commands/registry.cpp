#include "command/registry.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace servoctl {
namespace commands {

using command::Command;

extern const Command kScan;
extern const Command kBusStatus;
extern const Command kBusUp;
extern const Command kBusDown;
extern const Command kBusDetect;
extern const Command kDoctor;
extern const Command kInfo;
extern const Command kStatus;
extern const Command kRead;
extern const Command kWrite;
extern const Command kObjects;
extern const Command kExplain;
extern const Command kParamList;
extern const Command kParamGet;
extern const Command kParamSet;
extern const Command kParamSearch;
extern const Command kParamExplain;
extern const Command kBackup;
extern const Command kCabinetCheck;
extern const Command kCabinetInit;
extern const Command kCabinetShow;
extern const Command kCabinetPlan;
extern const Command kCabinetApply;
extern const Command kCabinetBackup;
extern const Command kCabinetSwap;
extern const Command kCabinetDiff;
extern const Command kDiff;
extern const Command kVerify;
extern const Command kRestore;
extern const Command kClone;
extern const Command kAddress;
extern const Command kLssScan;
extern const Command kLssInquire;
extern const Command kLssSelect;
extern const Command kLssSetNode;
extern const Command kLssSetBitrate;
extern const Command kLssStore;
extern const Command kStore;
extern const Command kDefaults;
extern const Command kFaultShow;
extern const Command kFaultList;
extern const Command kFaultReset;
extern const Command kFaultClearHistory;
extern const Command kEnable;
extern const Command kDisable;
extern const Command kQuickStopCommand;
extern const Command kStop;
extern const Command kMode;
extern const Command kJog;
extern const Command kMove;
extern const Command kHome;
extern const Command kTorque;
extern const Command kUnitsShow;
extern const Command kUnitsLearn;
extern const Command kUnitsForget;
extern const Command kHeartbeatSet;
extern const Command kHeartbeatConsume;
extern const Command kHeartbeatShow;
extern const Command kWatchdog;
extern const Command kNmtStart;
extern const Command kNmtStop;
extern const Command kNmtPreop;
extern const Command kNmtReset;
extern const Command kNmtResetComm;
extern const Command kNmtWatch;
extern const Command kStateInit;
extern const Command kStatePreop;
extern const Command kStateSafeop;
extern const Command kStateOp;
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
extern const Command kWitness;
extern const Command kSyncOnce;
extern const Command kSyncStart;
extern const Command kSyncStop;
extern const Command kWatch;
extern const Command kScope;
extern const Command kMonitor;
extern const Command kDecode;
extern const Command kReplay;
extern const Command kDrives;
extern const Command kDrivesCheck;
extern const Command kDrivesNew;
extern const Command kEdsCheck;
extern const Command kEdsVerify;
extern const Command kEdsLearn;
extern const Command kRun;
extern const Command kSim;
extern const Command kGateway;
extern const Command kHelp;
extern const Command kMan;
extern const Command kCompletion;

}  // namespace commands

namespace command {

namespace {

/// The paths stand together: to find a command touches one page of memory, and those of no other command.
struct Named {
  char path[24];
  const Command* command;
};
constexpr Named kNamed[] = {
    {"scan", &commands::kScan},
    {"bus status", &commands::kBusStatus},
    {"bus up", &commands::kBusUp},
    {"bus down", &commands::kBusDown},
    {"bus detect", &commands::kBusDetect},
    {"doctor", &commands::kDoctor},
    {"info", &commands::kInfo},
    {"status", &commands::kStatus},
    {"read", &commands::kRead},
    {"write", &commands::kWrite},
    {"explain", &commands::kExplain},
    {"objects", &commands::kObjects},
    {"param list", &commands::kParamList},
    {"param get", &commands::kParamGet},
    {"param set", &commands::kParamSet},
    {"param search", &commands::kParamSearch},
    {"param explain", &commands::kParamExplain},
    {"backup", &commands::kBackup},
    {"cabinet init", &commands::kCabinetInit},
    {"cabinet check", &commands::kCabinetCheck},
    {"cabinet show", &commands::kCabinetShow},
    {"cabinet plan", &commands::kCabinetPlan},
    {"cabinet apply", &commands::kCabinetApply},
    {"cabinet backup", &commands::kCabinetBackup},
    {"cabinet swap", &commands::kCabinetSwap},
    {"cabinet diff", &commands::kCabinetDiff},
    {"diff", &commands::kDiff},
    {"verify", &commands::kVerify},
    {"restore", &commands::kRestore},
    {"clone", &commands::kClone},
    {"address", &commands::kAddress},
    {"lss scan", &commands::kLssScan},
    {"lss inquire", &commands::kLssInquire},
    {"lss select", &commands::kLssSelect},
    {"lss set-node", &commands::kLssSetNode},
    {"lss set-bitrate", &commands::kLssSetBitrate},
    {"lss store", &commands::kLssStore},
    {"store", &commands::kStore},
    {"defaults", &commands::kDefaults},
    {"fault show", &commands::kFaultShow},
    {"fault list", &commands::kFaultList},
    {"fault reset", &commands::kFaultReset},
    {"fault clear-history", &commands::kFaultClearHistory},
    {"enable", &commands::kEnable},
    {"disable", &commands::kDisable},
    {"quick-stop", &commands::kQuickStopCommand},
    {"stop", &commands::kStop},
    {"mode", &commands::kMode},
    {"jog", &commands::kJog},
    {"move", &commands::kMove},
    {"home", &commands::kHome},
    {"torque", &commands::kTorque},
    {"units show", &commands::kUnitsShow},
    {"units learn", &commands::kUnitsLearn},
    {"units forget", &commands::kUnitsForget},
    {"heartbeat set", &commands::kHeartbeatSet},
    {"heartbeat consume", &commands::kHeartbeatConsume},
    {"heartbeat show", &commands::kHeartbeatShow},
    {"watchdog", &commands::kWatchdog},
    {"nmt start", &commands::kNmtStart},
    {"nmt stop", &commands::kNmtStop},
    {"nmt preop", &commands::kNmtPreop},
    {"nmt reset", &commands::kNmtReset},
    {"nmt reset-comm", &commands::kNmtResetComm},
    {"nmt watch", &commands::kNmtWatch},
    {"state init", &commands::kStateInit},
    {"state preop", &commands::kStatePreop},
    {"state safeop", &commands::kStateSafeop},
    {"state op", &commands::kStateOp},
    {"pdo show", &commands::kPdoShow},
    {"pdo map", &commands::kPdoMap},
    {"pdo enable", &commands::kPdoEnable},
    {"pdo disable", &commands::kPdoDisable},
    {"pdo clear", &commands::kPdoClear},
    {"pdo preset", &commands::kPdoPreset},
    {"pdo apply", &commands::kPdoApply},
    {"pdo save", &commands::kPdoSave},
    {"pdo watch", &commands::kPdoWatch},
    {"pdo send", &commands::kPdoSend},
    {"test comm", &commands::kTestComm},
    {"test io", &commands::kTestIo},
    {"test jog", &commands::kTestJog},
    {"test home", &commands::kTestHome},
    {"test all", &commands::kTestAll},
    {"report", &commands::kReport},
    {"witness", &commands::kWitness},
    {"sync once", &commands::kSyncOnce},
    {"sync start", &commands::kSyncStart},
    {"sync stop", &commands::kSyncStop},
    {"watch", &commands::kWatch},
    {"scope", &commands::kScope},
    {"monitor", &commands::kMonitor},
    {"decode", &commands::kDecode},
    {"replay", &commands::kReplay},
    {"drives", &commands::kDrives},
    {"drives check", &commands::kDrivesCheck},
    {"drives new", &commands::kDrivesNew},
    {"eds check", &commands::kEdsCheck},
    {"eds verify", &commands::kEdsVerify},
    {"eds learn", &commands::kEdsLearn},
    {"run", &commands::kRun},
    {"sim", &commands::kSim},
    {"gateway", &commands::kGateway},
    {"help", &commands::kHelp},
    {"man", &commands::kMan},
    {"completion", &commands::kCompletion},
};
constexpr auto kAll = [] {
  std::array<const Command*, std::size(kNamed)> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = kNamed[i].command;
  return out;
}();

}  // namespace

std::span<const Command* const> registry() { return kAll; }

std::string_view registered_path(std::size_t index) { return kNamed[index].path; }

const Command* find_command(std::string_view path) {
  const auto* const found =
      std::find_if(std::begin(kNamed), std::end(kNamed), [&](const Named& n) { return n.path == path; });
  return found == std::end(kNamed) ? nullptr : found->command;
}

}  // namespace command
}  // namespace servoctl
