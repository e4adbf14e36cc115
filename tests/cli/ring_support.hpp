#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <set>
#include <string>

#include "cli/admission.hpp"
#include "command/registry.hpp"
#include "drive/standard_objects.hpp"
#include "ethercat/registers.hpp"
#include "session/scan.hpp"
#include "show/notice.hpp"
#include "sim/esc_cell.hpp"
#include "tests/session/ethercat_world.hpp"
#include "tests/show/audiences.hpp"

namespace servoctl::cli {

using command::Arguments;
using session::NodeState;
using sim::EscState;
using std::chrono::milliseconds;
using RingWords = std::initializer_list<std::pair<std::string_view, std::string>>;

/// Commands on a ring of simulated slaves, in virtual time.
class RingTest : public session::EtherCatTest {
 protected:
  /// One slave that is not as it should be.
  void open_with(sim::SiiFault fault, std::uint16_t alias = 0) {
    sim::EscCell cell;
    cell.profiles.push_back(std::make_unique<drive::Profile>(drive::load_profile("sv2", folders()).value()));
    cell.memory = std::make_unique<sim::Memory>();
    auto options = sim::EscSlave::Options::of(*cell.profiles.front());
    options.sii = fault;
    options.alias = alias;
    cell.slaves.push_back(
        std::make_unique<sim::EscSlave>(*cell.profiles.front(), 1, *cell.memory, "1", options));
    const sim::SimClock clock(sim::SimClock::Kind::virtual_time);
    cell.ring.attach(*cell.slaves.back(), clock.now());
    port_ = std::make_unique<sim::SimPort>(std::move(cell), clock);
    session_ = connect();
  }
  static std::vector<std::filesystem::path> folders() {
    return {std::filesystem::path(source_dir()) / "eds"};
  }

  /// Runs one command as the shell does; its notices and errors are in `context`.
  std::string run(std::string_view path, std::vector<std::uint8_t> nodes = {}, RingWords words = {}) {
    return run_on(*session_, path, std::move(nodes), words);
  }
  std::string run_on(session::Session& session, std::string_view path, std::vector<std::uint8_t> nodes,
                     RingWords words = {}) {
    Arguments arguments;
    for (const auto& [name, value] : words) arguments.add(name, value);
    context = {};
    context.session = &session;
    context.drive_folders = folders();
    context.nodes_typed = !nodes.empty();
    context.nodes = std::move(nodes);
    context.audience = audience;
    const auto* found = command::find_command(path);
    EXPECT_TRUE(check_network(*found, session)) << path;
    const auto done = found->run(context, arguments);
    if (!done) context.errors.push_back(done.error());
    return done ? report::to_json(*done) : done.error().message.text();
  }
  bool notes(std::string_view text) const {
    return std::any_of(context.notices.begin(), context.notices.end(),
                       [&](const auto& line) { return line.text().find(text) != std::string::npos; });
  }
  std::string notices() const {
    std::string out;
    for (const auto& notice : context.notices) out += notice.text() + "\n";
    for (const auto& error : context.errors) out += error.message.text() + "; " + error.hint.text() + "\n";
    return out;
  }
  void energise() {
    for (const auto word : {6U, 7U, 15U})
      ASSERT_TRUE(session_->download(1, objects::kControlword, store_le(word, 2)));
    pass(milliseconds(200));
    ASSERT_TRUE(drive::is_energised(slave().model().power_state()));
  }
  std::uint16_t station(std::size_t index = 0) {
    Bytes out(2);
    (void)slave(index).registers().read(ethercat::reg::kStationAddress, out);
    return static_cast<std::uint16_t>(load_le(out));
  }

  command::Context context;
  show::Willing willing;
  show::Unwilling unwilling;
  show::Audience* audience = &willing;
};

}  // namespace servoctl::cli
