#include "command/report_collection.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "base/format.hpp"
#include "cabinet/axis_sheet.hpp"
#include "cabinet/cabinet.hpp"
#include "command/command.hpp"
#include "command/one_drive.hpp"
#include "command/registry.hpp"
#include "drive/provenance.hpp"
#include "trial/comm_trial.hpp"
#include "trial/report_head.hpp"
#include "trial/verdict.hpp"

namespace servoctl::command {
namespace {

using report::List;
using report::Record;
using report::Show;
using report::TestResult;
using report::Value;

/// A test that was made before, and whether a drive of the report was found for it.
struct Tested {
  trial::EarlierTest test;
  bool taken = false;
};

class Collection {
 public:
  Collection(Context& context, std::vector<trial::EarlierTest> earlier) : first_(&context) {
    for (auto& test : earlier) earlier_.push_back({std::move(test)});
    contexts_ = {&context};
    contexts_.insert(contexts_.end(), context.others.begin(), context.others.end());
    for (const auto* each : contexts_) several_ = several_ || each->session != context.session;
    for (auto* each : contexts_) {
      auto& names = names_[each];
      for (const auto* axis : each->axes) {
        names[axis->node] = axis->name;
        buses_[each] = axis->bus;
        order_.push_back({axis, each, axis->node});
      }
      if (each->axes.empty())
        for (const auto node : each->nodes) order_.push_back({nullptr, each, node});
    }
    // As they stand in the file.
    std::stable_sort(order_.begin(), order_.end(),
                     [](const Place& a, const Place& b) { return std::less<>()(a.axis, b.axis); });
  }

  Result<trial::Report> make(trial::ReportCover cover) {
    out_.cover = std::move(cover);
    if (out_.cover.title.empty()) out_.cover.title = say("Commissioning report");
    if (const auto same = take_earlier(); !same) return fail(same.error());
    for (auto* context : contexts_) {
      context_ = context;
      if (const auto told = of_bus(); !told) return ended(told.error());
    }
    for (const auto& place : order_) {
      context_ = place.context;
      auto drive = of_drive(place.node);
      if (!drive) return ended(drive.error());
      out_.drives.push_back(std::move(*drive));
    }
    // Of the whole command now: said once.
    if (answered_ == 0) return fail(first_error());
    const std::vector<const show::Desk*> desks(contexts_.begin(), contexts_.end());
    out_.head = trial::report_head(desks, out_.cover, tests_);
    return std::move(out_);
  }

 private:
  std::string say(std::string_view english) const { return trial::say(*first_, english); }

  /// A bus that is lost is that of the drive that was asked.
  tl::unexpected<Error> ended(const Error& error) {
    if (error.code == Errc::bus && context_ != first_) first_->failed = context_;
    return fail(error);
  }

  Error first_error() {
    auto out = make_error(Errc::negative, "no drive of the report answered", "`scan` shows who does");
    for (auto context = contexts_.rbegin(); context != contexts_.rend(); ++context)
      if (const auto errors = std::exchange((*context)->errors, {}); !errors.empty()) out = errors.front();
    return out;
  }

  std::string name_of(std::uint8_t node) const {
    const auto& names = names_.at(context_);
    const auto found = names.find(node);
    return found == names.end() ? std::string() : found->second;
  }

  /// As the cabinet file calls it.
  std::string bus_name() const {
    const auto found = buses_.find(context_);
    return found == buses_.end() ? context_->session->url() : found->second;
  }

  /// Which drives the earlier tests are of: the same ones as now.
  Result<void> take_earlier() {
    for (auto* context : contexts_) {
      context_ = context;
      std::vector<TestResult> of_these;
      for (const auto node : context->nodes)
        for (auto& one : earlier_) {
          if (!is_of(one, node)) continue;
          one.taken = true;
          one.test.result.node = node;
          of_these.push_back(one.test.result);
        }
      if (const auto same = trial::check_tested(*context, of_these); !same) return same;
    }
    for (const auto& one : earlier_)
      if (!one.taken) first_->notices.push_back(not_taken(one.test));
    return {};
  }

  static std::string not_taken(const trial::EarlierTest& test) {
    if (!test.axis.empty())
      return formatted("test {} of axis {} is not in the report: add the axis to -n", test.result.test,
                       test.axis);
    return formatted("test {} of node {} is not in the report: add the node to -n", test.result.test,
                     test.result.node);
  }

  bool is_of(const Tested& one, std::uint8_t node) const {
    const auto name = name_of(node);
    const auto url = several_ ? context_->session->url() : std::string();
    return trial::is_of(one.test, {node, name, url});
  }

  Result<void> of_bus() {
    const auto url = context_->session->url();
    for (const auto& bus : out_.buses)
      if (bus.url == url) return {};
    auto found = part("bus", say("Bus"), "scan", {}, {});
    if (!found) return fail(found.error());
    out_.buses.push_back({url, bus_name(), trial::link_record(*context_), std::move(*found)});
    return {};
  }

  /// Runs a command for one drive (for the bus where there is none). A difference or a fault is what a report
  /// is there to tell: no error of it.
  Result<trial::ReportPart> part(std::string id, std::string title, std::string_view command,
                                 std::optional<std::uint8_t> node, const Arguments& arguments) {
    return part(std::move(id), std::move(title), node, [&](Context& inner) -> Result<Value> {
      auto result = find_command(command)->run(inner, arguments);
      return result && node ? Result<Value>(of_one_drive(std::move(*result))) : result;
    });
  }

  template <class Ask>
  Result<trial::ReportPart> part(std::string id, std::string title, std::optional<std::uint8_t> node,
                                 const Ask& ask) {
    Context inner = *context_;
    inner.errors.clear();
    inner.notices.clear();
    inner.nodes.clear();
    if (node) inner.nodes.push_back(*node);
    auto result = ask(inner);
    if (!result) inner.errors.push_back(result.error());
    trial::ReportPart out{std::move(id), std::move(title), {}, {}};
    for (const auto& notice : inner.notices) out.remarks.push_back(notice.text());
    for (auto& error : inner.errors) {
      if (error.code == Errc::bus || error.code == Errc::interrupted) return fail(std::move(error));
      if (error.code == Errc::negative) continue;
      out.remarks.push_back(error.message.text());
      context_->errors.push_back(std::move(error));
    }
    if (result) out.value = std::move(*result);
    return out;
  }

  std::string title_of(std::uint8_t node) const {
    const auto name = name_of(node);
    return name.empty() ? say(formatted("Node {}", node)) : say(formatted("{} (node {})", name, node));
  }

  Result<trial::DriveReport> of_drive(std::uint8_t node) {
    struct Wanted {
      std::string_view id;
      std::string_view title;
      std::string_view command;
    };
    static constexpr Wanted kParts[] = {
        {"identity", "Identity", "info"},
        {"state", "State", "status"},
        {"faults", "Faults", "fault show"},
        {"settings", "Settings that differ from factory values", "verify"},
        {"pdos", "Process data (PDO)", "pdo show"},
    };
    trial::DriveReport out{.node = node,
                           .axis = name_of(node),
                           .bus = context_->session->url(),
                           .bus_name = bus_name(),
                           .family = context_->profile->family,
                           .title = title_of(node)};
    Arguments factory;
    factory.add("file", "factory");
    for (const auto& wanted : kParts) {
      auto one = part(std::string(wanted.id), say(wanted.title), wanted.command, node, factory);
      if (!one) return fail(one.error());
      const bool silent = one->value.is_null() && wanted.id == "identity";
      if (wanted.id == "identity")
        one->remarks.push_back(say(formatted("the drive data were checked against: {}",
                                             drive::provenance_text(*context_->profile, context_->chinese))));
      out.parts.push_back(std::move(*one));
      if (silent) return out;  // Each further part would only wait for it.
    }
    ++answered_;
    if (const auto held = add_cabinet(out); !held) return fail(held.error());
    if (const auto tested = add_tests(node, out); !tested) return fail(tested.error());
    return out;
  }

  /// What the cabinet file says of it, where it is one of its axes.
  Result<void> add_cabinet(trial::DriveReport& drive) {
    if (drive.axis.empty() || context_->front_end == nullptr) return {};
    auto one = part("cabinet", say("Cabinet file"), drive.node, [&](Context& inner) -> Result<Value> {
      const auto cabinet = inner.front_end->cabinet();
      if (!cabinet) return fail(cabinet.error());
      const auto* axis = (*cabinet)->axis(drive.axis);
      if (axis == nullptr) return Value();
      return cabinet::axis_sheet(inner, **cabinet, *axis, drive::find_families(inner.drive_folders));
    });
    if (!one) return fail(one.error());
    drive.parts.push_back(std::move(*one));
    return {};
  }

  Result<void> add_tests(std::uint8_t node, trial::DriveReport& drive) {
    // Of several tests of the communication the last one given counts.
    std::vector<TestResult> earlier;
    for (const auto& one : earlier_) {
      if (!is_of(one, node)) continue;
      if (one.test.result.test == trial::kCommTestName)
        std::erase_if(earlier, [](const TestResult& test) { return test.test == trial::kCommTestName; });
      earlier.push_back(one.test.result);
    }
    if (std::none_of(earlier.begin(), earlier.end(),
                     [](const TestResult& test) { return test.test == trial::kCommTestName; })) {
      auto comm = trial::test_communication(*context_, node, {});
      if (!comm) return fail(comm.error());
      comm->origin = trial::origin_of(*context_, node);
      earlier.insert(earlier.begin(), std::move(*comm));
    }
    drive.tests = std::move(earlier);
    for (const auto& result : drive.tests) {
      ++tests_.all;
      if (passed(result)) continue;
      ++tests_.failed;
      context_->errors.push_back(trial::failure(result));
    }
    return {};
  }

  struct Place {
    const void* axis;  ///< Tells the order, no more.
    Context* context;
    std::uint8_t node;
  };

  Context* first_;
  std::vector<Tested> earlier_;
  std::vector<Context*> contexts_;
  std::vector<Place> order_;
  bool several_ = false;        ///< Buses.
  Context* context_ = nullptr;  ///< Of the drive that is asked.
  /// A cabinet file that is read anew takes the axes with it.
  std::map<const Context*, std::map<std::uint8_t, std::string>> names_;
  std::map<const Context*, std::string> buses_;
  trial::Report out_;
  std::size_t answered_ = 0;
  trial::TestCount tests_;
};

}  // namespace

Result<trial::Report> collect_report(Context& context, trial::ReportCover cover,
                                     std::vector<trial::EarlierTest> earlier) {
  return Collection(context, std::move(earlier)).make(std::move(cover));
}

}  // namespace servoctl::command
