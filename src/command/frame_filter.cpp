#include "command/frame_filter.hpp"

#include <algorithm>

namespace servoctl::command {

Result<traffic::FrameFilter> frame_filter(const Context& context, const Arguments& arguments) {
  traffic::FrameFilter out;
  if (!context.nodes.empty() && context.nodes.front() != 0) out.nodes = context.nodes;
  for (const auto& service : arguments.all("--service"))
    out.services.push_back(*std::find(std::begin(traffic::kServices), std::end(traffic::kServices), service));
  for (const auto& name : arguments.all("--object")) {
    const auto target = drive::resolve(context.profile, name);
    if (!target) return fail(target.error());
    out.objects.push_back(target->address);
  }
  return out;
}

}  // namespace servoctl::command
