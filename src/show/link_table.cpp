#include "show/link_table.hpp"

#include "base/format.hpp"
#include "can/link_change.hpp"
#include "drive/bitrate.hpp"

namespace servoctl::show {
namespace {

using report::Record;
using report::Show;
using report::Value;

template <class T>
Value number(const std::optional<T>& value) {
  return value ? Value(*value) : Value();
}

Value bitrate_of(const can::LinkState& state) {
  return state.bitrate ? Value(drive::bitrate_text(*state.bitrate)) : Value();
}

Value sample_point_of(const can::LinkState& state) {
  return state.sample_point ? Value(formatted("{:.1f} %", *state.sample_point / 10.0)) : Value();
}

Value health_of(const can::LinkState& state) {
  return state.health ? Value(can::name(*state.health)) : Value();
}

/// `tx 0, rx 128`
Value counters_of(const can::LinkState& state) {
  if (!state.tx_errors || !state.rx_errors) return {};
  return formatted("tx {}, rx {}", *state.tx_errors, *state.rx_errors);
}

Value restart_of(const can::LinkState& state) {
  if (!state.restart_ms) return {};
  return *state.restart_ms == 0 ? Value("not by itself") : Value(formatted("after {} ms", *state.restart_ms));
}

std::string driver_of(const std::string& name, const can::LinkState& state) {
  auto driver = can::link_driver(name);
  return driver.empty() ? state.kind : driver;
}

std::string mode_of(const can::LinkState& state) {
  return state.listen_only ? "listen-only" : state.loopback ? "loopback" : "";
}

Value history_of(const can::LinkState& state) {
  if (!state.history) return {};
  const auto& h = *state.history;
  return Record{{"bus_off", h.bus_off, Show::everywhere, "bus-off"},
                {"restarts", h.restarts},
                {"error_passive", h.error_passive, Show::everywhere, "error-passive"},
                {"error_warning", h.error_warning, Show::everywhere, "error-warning"},
                {"bus_errors", h.bus_errors, Show::everywhere, "bus errors"},
                {"arbitration_lost", h.arbitration_lost, Show::everywhere, "arbitration lost"}};
}

Value traffic_of(const can::LinkState& state) {
  const auto& t = state.traffic;
  return Record{{"received", t.received},
                {"sent", t.sent},
                {"receive_errors", t.receive_errors, Show::everywhere, "receive errors"},
                {"send_errors", t.send_errors, Show::everywhere, "send errors"},
                {"receive_dropped", t.receive_dropped, Show::everywhere, "receive dropped"},
                {"send_dropped", t.send_dropped, Show::everywhere, "send dropped"},
                {"overrun", t.overrun}};
}

Value right_value() {
  const auto may = can::may_change_links();
  return may ? Value(*may) : Value();
}

}  // namespace

report::Record link_record(const std::string& name, const can::LinkState& state) {
  const auto thousandths = state.sample_point ? Value(*state.sample_point / 1000.0) : Value();
  return {{"interface", name},
          {"up", state.up},
          {"state", health_of(state)},
          {"bitrate_text", bitrate_of(state), Show::text, "bitrate"},
          {"bitrate", number(state.bitrate), Show::json},
          {"sample_point_text", sample_point_of(state), Show::text, "sample point"},
          {"sample_point", thousandths, Show::json},
          {"errors_text", counters_of(state), Show::text, "error counters"},
          {"tx_errors", number(state.tx_errors), Show::json},
          {"rx_errors", number(state.rx_errors), Show::json},
          {"restart_text", restart_of(state), Show::text, "restart after bus-off"},
          {"restart_ms", number(state.restart_ms), Show::json},
          {"queue_length", state.queue_length, Show::everywhere, "queue length"},
          {"mode", report::text_or_null(mode_of(state))},
          {"termination", number(state.termination), Show::everywhere, "own termination (ohm)"},
          {"kind", state.kind},
          {"driver", report::text_or_null(can::link_driver(name))},
          {"receivers", can::link_receivers(name), Show::everywhere, "sockets that receive"},
          {"may_change", right_value(), Show::everywhere, "may be changed by you"},
          {"history", history_of(state), Show::everywhere, "since the driver was loaded"},
          {"traffic", traffic_of(state), Show::everywhere, "frames"}};
}

report::Table link_table(std::span<const NamedLink> links) {
  report::Table table;
  table.columns = {{"interface"}, {"up"},      {"state"}, {"bitrate"}, {"sample point"},
                   {"errors"},    {"bus-off"}, {"queue"}, {"driver"},  {"mode"}};
  for (const auto& link : links) {
    const auto& state = link.state;
    table.rows.push_back({link.name, state.up ? "up" : "down", health_of(state), bitrate_of(state),
                          sample_point_of(state), counters_of(state),
                          state.history ? Value(state.history->bus_off) : Value(), state.queue_length,
                          driver_of(link.name, state), report::text_or_null(mode_of(state))});
    table.documents.emplace_back(link_record(link.name, state));
  }
  return table;
}

}  // namespace servoctl::show
