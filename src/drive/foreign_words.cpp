#include "drive/foreign_words.hpp"

#include <array>
#include <utility>

#include "base/text.hpp"

namespace servoctl::drive {
namespace {

using Pair = std::pair<std::string_view, std::string_view>;

/// Lower case without blanks, `_`, `-`, `/`.
std::string folded_cell(std::string_view text) {
  auto out = lower(text);
  std::erase_if(out, [](char c) { return c == ' ' || c == '_' || c == '-' || c == '/' || c == '.'; });
  return out;
}

template <std::size_t N>
std::string exactly(std::string_view text, const std::array<Pair, N>& words) {
  const auto folded = folded_cell(text);
  for (const auto& [word, meaning] : words)
    if (folded == word) return std::string(meaning);
  return std::string(text);
}

constexpr auto kTypes = std::to_array<Pair>({{"bool", "bool"},      {"boolean", "bool"},
                                             {"bit", "bool"},       {"byte", "u8"},
                                             {"usint", "u8"},       {"uint8", "u8"},
                                             {"uint8t", "u8"},      {"unsigned8", "u8"},
                                             {"sint", "i8"},        {"int8", "i8"},
                                             {"int8t", "i8"},       {"integer8", "i8"},
                                             {"word", "u16"},       {"uint", "u16"},
                                             {"uint16", "u16"},     {"uint16t", "u16"},
                                             {"unsigned16", "u16"}, {"int", "i16"},
                                             {"int16", "i16"},      {"int16t", "i16"},
                                             {"integer16", "i16"},  {"dword", "u32"},
                                             {"udint", "u32"},      {"uint32", "u32"},
                                             {"uint32t", "u32"},    {"unsigned32", "u32"},
                                             {"dint", "i32"},       {"int32", "i32"},
                                             {"int32t", "i32"},     {"integer32", "i32"},
                                             {"uint64", "u64"},     {"unsigned64", "u64"},
                                             {"int64", "i64"},      {"integer64", "i64"},
                                             {"real", "f32"},       {"real32", "f32"},
                                             {"float", "f32"},      {"float32", "f32"},
                                             {"lreal", "f64"},      {"real64", "f64"},
                                             {"double", "f64"},     {"visiblestring", "string"},
                                             {"string", "string"},  {"octetstring", "bytes"},
                                             {"u8", "u8"},          {"u16", "u16"},
                                             {"u32", "u32"},        {"i8", "i8"},
                                             {"i16", "i16"},        {"i32", "i32"},
                                             {"s8", "i8"},          {"s16", "i16"},
                                             {"s32", "i32"}});

constexpr auto kAccess = std::to_array<Pair>({{"rw", "rw"},
                                              {"wr", "rw"},
                                              {"rww", "rw"},
                                              {"rwr", "rw"},
                                              {"readwrite", "rw"},
                                              {"读写", "rw"},
                                              {"可读写", "rw"},
                                              {"可读可写", "rw"},
                                              {"r", "ro"},
                                              {"ro", "ro"},
                                              {"readonly", "ro"},
                                              {"只读", "ro"},
                                              {"wo", "wo"},
                                              {"writeonly", "wo"},
                                              {"只写", "wo"},
                                              {"const", "const"},
                                              {"constant", "const"},
                                              {"常量", "const"}});

/// Whole phrases alone: "not immediate" has "immediate" in it.
constexpr auto kEffects = std::to_array<Pair>({{"restart", "restart"},         {"afterrestart", "restart"},
                                               {"reboot", "restart"},          {"afterreboot", "restart"},
                                               {"powercycle", "restart"},      {"afterpowercycle", "restart"},
                                               {"repower", "restart"},         {"poweron", "restart"},
                                               {"nextpoweron", "restart"},     {"重启", "restart"},
                                               {"重启生效", "restart"},        {"重启后生效", "restart"},
                                               {"断电重启", "restart"},        {"断电重启生效", "restart"},
                                               {"重新上电", "restart"},        {"重新上电生效", "restart"},
                                               {"重新上电后生效", "restart"},  {"重新通电", "restart"},
                                               {"重新通电生效", "restart"},    {"再次上电", "restart"},
                                               {"再次上电生效", "restart"},    {"再次通电", "restart"},
                                               {"再次通电生效", "restart"},    {"standstill", "standstill"},
                                               {"atstandstill", "standstill"}, {"停机生效", "standstill"},
                                               {"immediate", "immediate"},     {"immediately", "immediate"},
                                               {"atonce", "immediate"},        {"立即", "immediate"},
                                               {"立即生效", "immediate"},      {"立刻生效", "immediate"},
                                               {"即时生效", "immediate"},      {"实时生效", "immediate"}});

constexpr auto kAnswers = std::to_array<Pair>({{"yes", "yes"},
                                               {"y", "yes"},
                                               {"true", "yes"},
                                               {"是", "yes"},
                                               {"可", "yes"},
                                               {"可以", "yes"},
                                               {"√", "yes"},
                                               {"○", "yes"},
                                               {"no", "no"},
                                               {"n", "no"},
                                               {"false", "no"},
                                               {"否", "no"},
                                               {"不可", "no"},
                                               {"不可以", "no"}});

constexpr auto kKinds = std::to_array<Pair>({{"fault", "fault"},
                                             {"error", "fault"},
                                             {"故障", "fault"},
                                             {"错误", "fault"},
                                             {"warning", "warning"},
                                             {"warn", "warning"},
                                             {"警告", "warning"},
                                             {"状态", "status"},
                                             {"status", "status"}});

}  // namespace

std::string family_type(std::string_view text) { return exactly(text, kTypes); }
std::string family_access(std::string_view text) { return exactly(text, kAccess); }
std::string family_effect(std::string_view text) { return exactly(text, kEffects); }
std::string family_answer(std::string_view text) { return exactly(text, kAnswers); }
std::string family_kind(std::string_view text) { return exactly(text, kKinds); }

}  // namespace servoctl::drive
