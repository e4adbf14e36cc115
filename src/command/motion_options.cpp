#include "command/motion_options.hpp"

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "canopen/cob_id.hpp"
#include "drive/standard_objects.hpp"
#include "motion/motion_needs.hpp"

namespace servoctl::command {
namespace {

std::optional<std::uint64_t> number(const Arguments& arguments, std::string_view name) {
  const auto value = parse_integer(arguments.text(name));
  return value && !value->negative ? std::optional(value->magnitude) : std::nullopt;
}

/// `NAME=VALUE,NAME=VALUE`.
Result<motion::PanelValues> panel_values(std::string_view text) {
  motion::PanelValues out;
  for (const auto part : split(text, ',')) {
    const auto equals = part.find('=');
    const auto number =
        equals == std::string_view::npos ? std::nullopt : parse_signed(part.substr(equals + 1));
    if (!number || equals == 0)
      return fail(Errc::usage, message("--panel: '{}' is not NAME=VALUE", as_it_is(part)),
                  "such as --panel PA-20=0");
    out[std::string(part.substr(0, equals))] = *number;
  }
  return out;
}

}  // namespace

Result<std::uint8_t> one_node(const Context& context) {
  if (context.nodes.size() == 1 && context.nodes.front() != 0) return context.nodes.front();
  return fail(Errc::usage, "one motor at a time: this command takes one node",
              message("-n {}", node_name(1)));
}

Result<motion::MotionOptions> motion_options(const Context& context, const Arguments& arguments) {
  motion::MotionOptions out;
  out.state_folder = context.state_folder;
  out.speed_limit = arguments.text("--limit");
  out.acceleration = arguments.text("--accel");
  out.max_torque = arguments.text("--max-torque");
  out.max_following_error = arguments.text("--max-following-error");
  out.window = arguments.text("--window");
  out.ignores_remote = arguments.has("--ignore-remote");
  out.unheard = [&context] { return context.audience_is_gone(); };
  for (const auto& [name, place] : {std::pair("--turn", &out.turn), std::pair("--encoder", &out.encoder)}) {
    if (!arguments.has(name)) continue;
    const auto counts = number(arguments, name);
    if (!counts || *counts == 0)
      return fail(Errc::usage, message("'{}' is not a number of counts", as_it_is(arguments.text(name))),
                  "such as 131072 for 17 bits");
    *place = static_cast<double>(*counts);
  }
  if (arguments.has("--panel")) {
    auto panel = panel_values(arguments.text("--panel"));
    if (!panel) return fail(panel.error());
    out.panel = std::move(*panel);
  }
  if (!arguments.has("--master-node")) return out;
  const auto id = number(arguments, "--master-node");
  if (!id || *id < canopen::kFirstNode || *id > canopen::kLastNode)
    return fail(Errc::usage, message("'{}' is not a node-ID", as_it_is(arguments.text("--master-node"))),
                "write 1..127");
  out.producer = static_cast<std::uint8_t>(*id);
  return out;
}

Result<motion::MotionRequest> motion_request(const Context& context, const Arguments& arguments) {
  const auto node = one_node(context);
  if (!node) return fail(node.error());
  auto options = motion_options(context, arguments);
  if (!options) return fail(options.error());
  if (const auto load = context.loads.find(*node); load != context.loads.end()) options->load = load->second;
  return motion::MotionRequest{*node, std::move(*options), std::string(arguments.text("--csv")),
                               arguments.has("--plot")};
}

motion::WrittenQuantity written_speed(std::string_view word) {
  return {.word = word,
          .object = objects::kTargetVelocity,
          .kind = motion::MotionUnits::Kind::way,
          .least = motion::WrittenQuantity::Least::not_zero};
}

Result<void> check_motion_words(const Context& context, const Arguments& arguments, drive::Use use,
                                std::initializer_list<motion::WrittenQuantity> own) {
  auto options = motion_options(context, arguments);
  if (!options) return fail(options.error());
  if (context.profile == nullptr || context.nodes.empty()) return {};
  if (const auto mode = motion::mode_for(*context.profile, use); !mode) return fail(mode.error());
  // All may be one in the end.
  const auto node = context.nodes.front();
  if (node != 0)
    if (const auto one = one_node(context); !one) return fail(one.error());
  if (const auto load = context.loads.find(node); load != context.loads.end()) options->load = load->second;
  std::vector<motion::WrittenQuantity> quantities(own);
  for (auto& quantity : quantities) quantity.text = arguments.text(quantity.word);
  return motion::check_written(*context.profile, node, *options, quantities);
}

}  // namespace servoctl::command
