#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "cabinet/cabinet.hpp"
#include "show/desk.hpp"

namespace servoctl::cabinet {

/// One axis, with what is needed to work on its drive.
struct Station {
  const Axis* axis = nullptr;
  const drive::Profile* profile = nullptr;
  session::Session* session = nullptr;
  std::optional<Error> away = {};  ///< Why the two are not there.
};

/// A desk for one axis: what holds for the line is that of `line`, who looks on is nobody.
show::Desk desk_at(const show::Desk& line, const Station& station);

/// Does the work for all stations that are there, at the same time: those of one session side by side on it
/// (session::Interleave), sessions in a thread each, or one after the other while another bus of this process
/// has to be served in every wait. `work` is called with the number of the station; it touches nothing that
/// another one does. Of a session `list_progress` tells how many of all have ended. What one throws is thrown
/// when all have ended.
void at_all(std::span<const Station> stations, const std::function<void(std::size_t station)>& work);

}  // namespace servoctl::cabinet
