#pragma once

#include <termios.h>

#include <string_view>

namespace servoctl::cli {

/// Catches every signal that ends a program and can be caught, but for those of a crash, so that every wait
/// ends in order; SIGPIPE and SIGXFSZ are ignored. A second Ctrl-C or Ctrl-\ while the first is still being
/// worked on ends the process at once, unless a drive is energised. Until clear_interrupt() a call that
/// blocks otherwise than in wait_or_signal(), such as a write of a library to a terminal that is held, ends
/// with EINTR again and again.
void install_signal_handlers();

/// Set true while a drive is energised: no number of signals ends or stops the process then, because it has
/// to stop the drive first. Ctrl-Z counts as Ctrl-C; one who reads or writes in the background is not
/// stopped. A signal that comes in between is handled as before or as afterwards.
void protect_from_signals(bool energised);

/// Whether one of them came since the last clear_interrupt().
bool interrupted();
/// Whether another than Ctrl-C came: the program has to end, not only what it is doing.
bool terminated();
void clear_interrupt();
/// How many of them have come so far.
unsigned times_signalled();

/// While it is lent, Ctrl-C and Ctrl-\ are for another program on the terminal that is waited for.
void lend_keyboard(bool lent);

/// What a second Ctrl-C gives the terminal at `descriptor` back before it ends the process, and Ctrl-Z before
/// it stops it, until forget_terminal_mode(): not every shell does so itself.
void keep_terminal_mode(int descriptor, const termios& before);
void forget_terminal_mode();
/// What they write to the standard output then, where it is taken: what ends the marks of pastes, or the
/// alternate screen. The text has to stay where it is; "" for nothing. The answer is what was kept before.
std::string_view keep_last_words(std::string_view words);
/// How often Ctrl-Z stopped the process and it went on: the terminal was given back then.
unsigned times_resumed();
/// Whether a change of the terminal's size ends a wait.
void note_resizes(bool notes);

}  // namespace servoctl::cli
