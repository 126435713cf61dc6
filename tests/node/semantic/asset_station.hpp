#pragma once

#include <cmath>
#include <fstream>

#include "semantic_station.hpp"

namespace concord {

/// A cube of 1 m as a file, in millimetres, and the folder that says so.
class AssetStation : public SemanticStation {
 protected:
  AssetStation() {
    const auto folder = site_.state / "assets";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "assets.yaml")
        << "cube: {file: cube.obj, class: box, unit: 0.001}\nnone: {file: none.obj}\n";
    std::ofstream out(folder / "cube.obj");
    for (int i = 0; i < 8; ++i)
      out << "v " << (i & 1) * 1000 << " " << (i >> 1 & 1) * 1000 << " " << (i >> 2) * 1000 << "\n";
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    out.close();
    run();  // it is looked for each second
  }

  Answer inject(const std::string& id, const std::string& asset, double x) {
    Transform T = Transform::Identity();
    T.translation().x() = x;
    return ask("in/asset", encode(AssetRequest{id, "eva", AssetRequest::Op::kInject, asset, "", {}, T, 5}));
  }
  /// Semantic's word, not merge's on the halves of it.
  Answer move(const std::string& id, const std::string& of, double x) {
    Transform T = Transform::Identity();
    T.translation().x() = x;
    ask("in/asset", encode(AssetRequest{id, "eva", AssetRequest::Op::kMove, "", of, {}, T, 5}));
    run();
    const auto own = std::ranges::find(answers_, id, &Answer::id);
    return own != answers_.end() ? *own : Answer{};
  }
  Answer take_out(const std::string& id, const std::string& of) {
    return ask("in/asset",
               encode(AssetRequest{id, "eva", AssetRequest::Op::kDelete, "", of, {}, Transform::Identity(), 5}));
  }
  Answer undo_edit(const std::string& id, const std::string& edit, bool redo = false) {
    const Answer answer = ask("in/undo", encode(UndoRequest{id, "eva", edit, redo, bus_->now()}));
    run();
    return answer;
  }
  /// What is where a cube at 2 m has its middle, and at 5 m, and at 8 m.
  [[nodiscard]] std::string places() const {
    std::string out;
    for (const std::int32_t x : {25, 55, 85}) out += (is_there(x) ? seen_at(x) : "-") + "|";
    return out;
  }
  /// Where the only model lies, as who asks what there is is told.
  [[nodiscard]] double told_x() const {
    const auto all = semantic_->view().answer({"q", LabelQuery::Kind::kAll, "", {0, 0, 0}, 0});
    return all && all->size() == 1 ? all->front().T_map_asset.translation().x() : NAN;
  }
  /// Somebody holds the cubic metre from there on for ten seconds.
  bool lease(const std::string& author, double x) {
    LeaseRequest lease;
    lease.id = "lease " + author;
    lease.author = author;
    lease.lease = "corner";
    lease.volume = Box{{x, 0, 0}, {x + 1, 1, 1}};
    lease.utime = bus_->now();
    return ask("in/lease", encode(lease)).ok;
  }
  [[nodiscard]] bool is_there(std::int32_t x) const { return is_occupied(merge_->map().at({x, 5, 5})); }
  [[nodiscard]] std::string seen_at(std::int32_t x) const {
    const LogOdds value = heard_.at({x, 5, 5});
    if (!is_known(value)) return "";
    const auto slot = std::ranges::find(slots_->items(), slot_of_value(value), &LabelSlot::slot);
    return slot == slots_->items().end() ? "?" : slot->name + " " + std::to_string(slot->of.instance);
  }
};

}  // namespace concord
