#pragma once

namespace concord {

/// semantic.db, schema by schema: what stands here was written by some release and is never changed.
///
/// `corrections` is what people did to the labels, in order, each as bytes (core/map_archive.md, "A label correction").
/// `placements` is where the agents' frames that labels lie on were last: twelve little-endian 64-bit numbers, rotation
/// row by row, translation. `thing_numbers`: of things that were seen, up to that they may have been given.
/// `deletions`: what those asked for whose edit is merge's: the hash of the request, without its time.
inline constexpr const char* kSemanticSchema[] = {
    R"sql(
CREATE TABLE site (resolution REAL NOT NULL);
CREATE TABLE corrections (revision INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE, correction BLOB NOT NULL);
CREATE TABLE placements (agent TEXT NOT NULL, frame_id TEXT NOT NULL, T_map_agent BLOB NOT NULL,
  PRIMARY KEY (agent, frame_id));
)sql",
    R"sql(
CREATE TABLE thing_numbers (spent INTEGER NOT NULL);
INSERT INTO thing_numbers VALUES (0);
)sql",
    R"sql(
CREATE TABLE deletions (id TEXT PRIMARY KEY, content INTEGER NOT NULL);
)sql",
};

}  // namespace concord
