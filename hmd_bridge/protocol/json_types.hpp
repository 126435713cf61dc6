#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/requests.hpp"
#include "core/text.hpp"

namespace concord::hmd {

using Json = nlohmann::json;

/// What a message was refused for: the first thing found, with the way to it.
struct Problem {
  std::string text;
  bool is_name = false;  ///< it is a text where a name must be

  bool say(const std::string& what) {
    if (text.empty()) text = what;
    return false;
  }
  /// The same, found at `place` of something larger.
  bool within(const std::string& place) {
    if (text.size() < 300) text = place + (text.starts_with('[') || text.starts_with(' ') ? "" : ".") + text;
    return false;
  }
};

/// The types of hmd.v1.toml. Each reads a JSON value strictly, within its bounds, and writes one; `read` answers
/// whether the value is of the type and says in `problem` why not.
namespace json_types {

struct Bool {
  using Value = bool;
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_boolean()) return problem.say(" must be true or false");
    out = json.get<bool>();
    return true;
  }
  static Json write(Value value) { return value; }
};

struct I32 {
  using Value = std::int32_t;
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_number_integer() || json < INT32_MIN || json > INT32_MAX)
      return problem.say(" must be a whole number of 32 bits");
    out = json.get<Value>();
    return true;
  }
  static Json write(Value value) { return value; }
};

struct Count {
  using Value = std::int64_t;
  static constexpr Value kMost = (Value{1} << 53) - 1;  ///< what JavaScript counts to
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_number_integer() || json < 0 || json > kMost)
      return problem.say(" must be a whole number from 0 to 2^53 - 1");
    out = json.get<Value>();
    return true;
  }
  static Json write(Value value) { return value; }
};

struct F64 {
  using Value = double;
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_number()) return problem.say(" must be a number");
    out = json.get<double>();
    return std::isfinite(out) || problem.say(" must be finite");
  }
  static Json write(Value value) { return value; }
};

template <std::size_t kMost>
struct Text {
  using Value = std::string;
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_string()) return problem.say(" must be a text");
    const auto& text = json.get_ref<const std::string&>();
    if (text.size() > kMost) return problem.say(" has over " + std::to_string(kMost) + " bytes");
    if (!is_printable(text)) return problem.say(" must be UTF-8 without control characters");
    out = text;
    return true;
  }
  static Json write(const Value& value) { return value; }
};

struct Name {
  using Value = std::string;
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_string() || !is_name(json.get_ref<const std::string&>())) {
      problem.is_name = problem.is_name || (json.is_string() && problem.text.empty());
      return problem.say(" must be 1 to 40 of A-Z a-z 0-9 . _ -, beginning with a letter or digit");
    }
    out = json.get_ref<const std::string&>();
    return true;
  }
  static Json write(const Value& value) { return value; }
};

template <class T, std::size_t kCount>
struct Array {
  using Value = std::array<typename T::Value, kCount>;
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_array() || json.size() != kCount) return problem.say(" must be " + std::to_string(kCount) + " values");
    for (std::size_t i = 0; i < kCount; ++i) {
      if (!T::read(json[i], out[i], problem)) return problem.within("[" + std::to_string(i) + "]");
    }
    return true;
  }
  static Json write(const Value& value) {
    Json json = Json::array();
    for (const auto& item : value) json.push_back(T::write(item));
    return json;
  }
};

template <class T, std::size_t kMost>
struct List {
  using Value = std::vector<typename T::Value>;
  static bool read(const Json& json, Value& out, Problem& problem) {
    if (!json.is_array()) return problem.say(" must be a list");
    if (json.size() > kMost) return problem.say(" has over " + std::to_string(kMost) + " items");
    out.clear();
    out.reserve(json.size());
    for (std::size_t i = 0; i < json.size(); ++i) {
      typename T::Value item{};
      if (!T::read(json[i], item, problem)) return problem.within("[" + std::to_string(i) + "]");
      out.push_back(std::move(item));
    }
    return true;
  }
  static Json write(const Value& value) {
    Json json = Json::array();
    for (const auto& item : value) json.push_back(T::write(item));
    return json;
  }
};

/// A declared enum, struct or union, by its generated functions.
template <class T>
struct Declared {
  using Value = T;
  static bool read(const Json& json, Value& out, Problem& problem) { return read_value(json, out, problem); }
  static Json write(const Value& value) { return write_value(value); }
};

/// The members of one object, each taken once; what is left over is refused.
class Members {
 public:
  Members(const Json& object, Problem& problem) : object_(object), problem_(problem) {
    if (!object.is_object()) failed_ = !problem.say(" must be an object");
  }

  template <class Type>
  void take(const char* name, typename Type::Value& out) {
    if (failed_) return;
    const auto it = object_.find(name);
    if (it == object_.end()) {
      failed_ = !problem_.say(std::string(" lacks ") + name);
      return;
    }
    read<Type>(name, *it, out);
  }
  template <class Type>
  void take(const char* name, std::optional<typename Type::Value>& out) {
    if (failed_) return;
    const auto it = object_.find(name);
    if (it != object_.end()) read<Type>(name, *it, out.emplace());
  }
  /// A member that the caller reads itself.
  void pass(const char* name) { known_.push_back(name); }

  /// Whether all were good and none is left over.
  [[nodiscard]] bool done() {
    if (failed_) return false;
    for (const auto& item : object_.items()) {
      if (std::find(known_.begin(), known_.end(), item.key()) == known_.end()) {
        return problem_.say(" has an unknown member " + cut_to(item.key(), 40));
      }
    }
    return true;
  }

 private:
  template <class Type>
  void read(const char* name, const Json& json, typename Type::Value& out) {
    known_.emplace_back(name);
    if (!Type::read(json, out, problem_)) failed_ = !problem_.within(name);
  }

  const Json& object_;
  Problem& problem_;
  std::vector<std::string> known_;
  bool failed_ = false;
};

template <class Type>
void put(Json& object, const char* name, const typename Type::Value& value) {
  object[name] = Type::write(value);
}
template <class Type>
void put(Json& object, const char* name, const std::optional<typename Type::Value>& value) {
  if (value) object[name] = Type::write(*value);
}

}  // namespace json_types
}  // namespace concord::hmd
