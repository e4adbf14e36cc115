#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drive/profile.hpp"
#include "session/session.hpp"

namespace servoctl::motion {

/// An axis of a node besides the one that servoctl commands: its objects are those of the first, 0800h
/// further for each (CiA 402-2).
struct OtherAxis {
  unsigned number = 2;                      ///< 2 to 8.
  std::optional<std::uint16_t> statusword;  ///< Of 6841h, 7041h …; empty where it did not answer.

  ObjectAddress statusword_object() const;
  ObjectAddress controlword_object() const;
  /// Whether it may be energised; one that tells nothing may.
  bool may_be_energised() const;
  std::string text() const;  ///< `axis 2 (0x6841:0) is in switch on disabled`
};

/// The further axes of a node, with their states. Where the family's own dictionary is known it decides.
/// Without it those that session::further_axes() finds. `profile` may be null.
std::vector<OtherAxis> other_axes(session::Session& session, const drive::Profile* profile,
                                  std::uint8_t node);

/// The device has N axes, and which one is meant: `the device has 2 axes; this is about axis 1 (0x6041:0)`.
/// Of a device without axis 1 that is said.
std::string axes_text(const std::vector<OtherAxis>& others, bool has_first = true);

/// Takes the power of these axes away with 07h and 00h, or sends 02h, and reads their states. Errc::negative
/// for the first that may still be energised.
Result<void> stop_axes(session::Session& session, std::uint8_t node, std::vector<OtherAxis>& axes,
                       bool disable);

}  // namespace servoctl::motion
