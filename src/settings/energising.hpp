#pragma once

#include <span>
#include <string>
#include <string_view>

#include "drive/power_parameter.hpp"
#include "session/write.hpp"
#include "session/write_plan.hpp"
#include "settings/change.hpp"
#include "show/desk.hpp"

/// Writes that give a motor power, or set it in motion.
namespace servoctl::settings {

/// Whether it is a controlword that enables the drive.
bool enables(const Change& change);

/// The parameter by which it energises the motor, or sets it in motion, without the controlword; null for
/// others.
const drive::PowerParameter* power_parameter(const show::Desk& desk, const Change& change);

/// What the write does beside changing a value; empty when nothing, as for a password.
std::string_view reason_to_ask(const show::Desk& desk, const Change& change);

/// What servoctl does not write into this object of a drive, whoever agrees: Errc::refused for a COB-ID that
/// no drive may have and, where the network gives a motor no power, for what energises one without the
/// controlword.
Result<void> check_writable(const show::Desk& desk, std::uint8_t node, ObjectAddress object,
                            const Bytes& data);

/// Says in `desk.notices` of which nodes a parameter was written, or may have been, that energises the motor
/// without the controlword: the way out of servoctl is that of 6040h. `written` is in the order of `changes`.
void tell_power_parameters(show::Desk& desk, std::span<const Change> changes,
                           std::span<const Result<session::Written>> written);

/// The same of a drive that is given `wanted` in place of `present`: sentences for a question, with a blank
/// before each, empty where nothing energises; and the notices.
std::string power_question(const show::Desk& desk, std::uint8_t node, const session::Values& present,
                           const session::Values& wanted);
void tell_power_values(show::Desk& desk, std::uint8_t node, const session::Values& present,
                       const session::Values& wanted);

}  // namespace servoctl::settings
