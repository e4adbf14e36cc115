#pragma once

#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/family_gate.hpp"
#include "cli/settings.hpp"
#include "command/command.hpp"
#include "report/catalogue.hpp"

namespace servoctl::cli {

class HeardStarts;
class Shell;

/// The shell as the command of one line sees it: who is asked and shown things, and who opens what its words
/// turn out to need.
class RunningLine final : public show::Audience, public command::FrontEnd {
 public:
  /// All outlive it.
  RunningLine(Shell& shell, const Settings& settings, command::Context& context);

  Result<void> confirm(std::string_view question) override;
  void emit(const report::Record& sample, std::string_view line) override;
  void write(std::string_view lines) override;
  void tell(std::string_view text) override;
  void show_progress(std::string_view line, TimePoint now) override;
  void show_share(double share, TimePoint begin, TimePoint now) override;
  std::size_t width() const override;
  std::unique_ptr<show::LiveView> open_view(const show::LiveView::Layout& layout) override;
  bool is_gone() const override;

  Result<session::Session*> open_bus() override;
  Result<const cabinet::Cabinet*> cabinet() override;
  Result<session::Session*> open_bus(const cabinet::Cabinet& cabinet, const cabinet::Bus& bus) override;
  std::string_view bus_url() const override { return settings_->bus; }
  session::Protection::Hold protect() override;
  void wait_for_no_reader() override;
  std::vector<std::uint8_t> energised_on(std::string_view url) const override;
  bool has_adapter(std::string_view adapter) const override;
  Result<void> release_adapter(std::string_view adapter) override;
  Result<std::unique_ptr<session::RingEnd>> open_ring_end() override;
  Result<std::unique_ptr<session::RegisterEnd>> open_register_end() override;
  Result<void> hold_family(std::span<const std::uint8_t> nodes, const drive::Profile* profile,
                           bool changes) override;
  Result<const drive::Profile*> family(const std::string& name) override;
  std::unique_ptr<command::Keys> open_keys() override;
  Result<std::vector<settings::SettingLine>> setting_lines(std::string_view text,
                                                           const std::string& file) override;

  /// As FamilyGate::Options::waits, of what is held from now on.
  void wait_for_late(bool waits) { waits_ = waits; }
  /// As FamilyGate::hold().
  Result<void> hold_family(std::span<const std::uint8_t> nodes, const drive::Profile* profile,
                           FamilyGate::Weight weight);

  /// Of the families of the line, if it has any; null in English.
  const report::Names* chinese_names();

 private:
  std::string in_language(std::string_view text);
  Result<void> hold_nodes(const HeardStarts& before) const;

  Shell* shell_;
  const Settings* settings_;
  command::Context* context_;
  std::set<const drive::Profile*> families_;  ///< That the line has asked for.
  std::set<const drive::Profile*> named_;     ///< Those whose names are known.
  report::Names names_;
  bool waits_ = false;
};

}  // namespace servoctl::cli
