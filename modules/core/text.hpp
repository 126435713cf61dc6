#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace concord {

/// What texts may be, in one place: for what comes over the bus, from files and from a command line, so that what was
/// read can be sent and what can be sent is understood.

inline constexpr std::size_t kMaxNameBytes = 40;   ///< of ids of agents, frames and maps
inline constexpr std::size_t kMaxTitleBytes = 80;  ///< of zones' names
inline constexpr std::size_t kMaxIdBytes = 80;     ///< of request ids and authors

/// Well-formed UTF-8 (RFC 3629) without zero bytes, at which LCM's encoder would cut: what JSON, logs and databases may
/// be given.
[[nodiscard]] bool is_utf8(std::string_view text);

/// The longest beginning of a UTF-8 text that has at most so many bytes and ends between two characters: half a
/// character is no text, and whoever writes it as JSON fails.
[[nodiscard]] std::string cut_to(std::string_view text, std::size_t most_bytes);

/// UTF-8 without ASCII control characters: one line. What was made under an earlier rule for names is still that, and
/// stays readable: in stores, saved maps, and lists of what there is.
[[nodiscard]] bool is_line(std::string_view text);

/// UTF-8 that a reader sees as it is: no control characters, none that turn the direction of text (U+202E would make
/// "gnihton" of a name), none that take no room. What people give and get back in answers, logs and lists.
[[nodiscard]] bool is_printable(std::string_view text);

/// Ids of agents, frames and maps: 1 to 40 of [A-Za-z0-9._-], starting with a letter or digit.
/// Such a name is safe as a file name and inside a channel name.
[[nodiscard]] bool is_name(std::string_view text);

/// Titles are for people: 1 to 80 printable bytes without slashes, neither dots alone nor a space at either end.
[[nodiscard]] bool is_title(std::string_view text);

/// Of requests, and so of edits and leases: 1 to 80 printable bytes, no space at either end.
[[nodiscard]] bool is_request_id(std::string_view text);

/// Who asks: at most 80 printable bytes, no space at either end. May be empty: nobody says.
[[nodiscard]] bool is_author(std::string_view text);

/// What was once taken from a person stays readable, can be undone and deleted, though the rules above have become
/// narrower since: one line of so many bytes, a title without slashes.
[[nodiscard]] bool is_kept_title(std::string_view text);
[[nodiscard]] bool is_kept_id(std::string_view text);
[[nodiscard]] bool is_kept_author(std::string_view text);

/// In words, for refusals.
inline constexpr const char* kKeptTitleRule = "one line of 1 to 80 bytes without slashes";
inline constexpr const char* kKeptIdRule = "one line of 1 to 80 bytes";
inline constexpr const char* kNameRule = "1 to 40 of A-Z a-z 0-9 . _ -, starting with a letter or digit";
inline constexpr const char* kTitleRule =
    "1 to 80 bytes of printable text without slashes and invisible characters, not dots alone, no space at its ends";
inline constexpr const char* kIdRule =
    "1 to 80 bytes of printable text without invisible characters, no space at its ends";
inline constexpr const char* kAuthorRule =
    "at most 80 bytes of printable text without invisible characters, no space at its ends";

}  // namespace concord
