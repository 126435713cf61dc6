#pragma once

namespace concord {

/// semantic.db, schema by schema: what stands here was written by some release and is never changed.
///
/// `corrections` is what people did to the labels, in order; `a`, `b` are the instances that it concerns, `text` is a
/// class's name or the id of a correction. Voxels are boxes: six little-endian 32-bit numbers each, the lowest voxel
/// and the highest one.
inline constexpr const char* kSemanticSchema[] = {
    R"sql(
CREATE TABLE site (resolution REAL NOT NULL);
CREATE TABLE corrections (revision INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE, author TEXT NOT NULL,
  utime INTEGER NOT NULL, content INTEGER NOT NULL, kind TEXT NOT NULL, label INTEGER NOT NULL,
  instance INTEGER NOT NULL, to_label INTEGER NOT NULL, to_instance INTEGER NOT NULL, text TEXT NOT NULL,
  edit_id TEXT NOT NULL, voxels BLOB NOT NULL);
)sql",
};

}  // namespace concord
