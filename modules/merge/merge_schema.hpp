#pragma once

namespace concord {

/// merge.db, schema by schema: what stands here was written by some release and is never changed.
///
/// `corrections` is what people did, in order; what belongs to each stands in the table of its kind, by revision.
/// Undo and redo need only their subject, the edit's id. Voxels are boxes: six little-endian 32-bit numbers each, the
/// lowest voxel and the highest one.
inline constexpr const char* kMergeSchema[] = {
    R"sql(
CREATE TABLE site (resolution REAL NOT NULL);
CREATE TABLE transforms (agent TEXT NOT NULL, frame_id TEXT NOT NULL, incarnation INTEGER NOT NULL,
  has_layer INTEGER NOT NULL, author TEXT NOT NULL, utime INTEGER NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, qw REAL NOT NULL,
  PRIMARY KEY (agent, frame_id, incarnation));
CREATE TABLE edits (revision INTEGER PRIMARY KEY AUTOINCREMENT, edit_id TEXT NOT NULL UNIQUE, author TEXT NOT NULL,
  utime INTEGER NOT NULL, op INTEGER NOT NULL, boxes BLOB NOT NULL);
)sql",
    // Edits keep their revisions, which clients know; transforms had none and follow in the order of time. What was
    // asked is no longer known: content 0.
    R"sql(
CREATE TABLE corrections (revision INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE, author TEXT NOT NULL,
  utime INTEGER NOT NULL, kind TEXT NOT NULL, subject TEXT NOT NULL, content INTEGER NOT NULL);
ALTER TABLE edits RENAME TO edits_1;
CREATE TABLE edits (revision INTEGER PRIMARY KEY REFERENCES corrections, added BLOB NOT NULL, deleted BLOB NOT NULL);
CREATE TABLE zones (revision INTEGER PRIMARY KEY REFERENCES corrections, kind TEXT NOT NULL, volume TEXT NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL, rotation TEXT NOT NULL);
CREATE TABLE placements (revision INTEGER PRIMARY KEY REFERENCES corrections, frame_id TEXT NOT NULL,
  incarnation INTEGER NOT NULL, has_layer INTEGER NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL, rotation TEXT NOT NULL);
CREATE TABLE weights (revision INTEGER PRIMARY KEY REFERENCES corrections, weight INTEGER NOT NULL);

INSERT INTO corrections SELECT revision, edit_id, author, utime, CASE op WHEN 1 THEN 'add' ELSE 'delete' END, '', 0
  FROM edits_1;
INSERT INTO edits SELECT revision, CASE op WHEN 1 THEN boxes ELSE x'' END, CASE op WHEN 1 THEN x'' ELSE boxes END
  FROM edits_1;

CREATE TEMP TABLE ordered AS SELECT *, row_number() OVER (ORDER BY utime, agent, frame_id, incarnation)
  + (SELECT coalesce(max(revision), 0) FROM edits_1) AS revision FROM transforms;
INSERT INTO corrections SELECT revision, 'placed-' || lower(hex(randomblob(12))), author, utime, 'transform', agent, 0
  FROM ordered ORDER BY revision;
INSERT INTO placements SELECT revision, frame_id, incarnation, has_layer, x, y, z,
  printf('%!.17g %!.17g %!.17g %!.17g %!.17g %!.17g %!.17g %!.17g %!.17g',
    1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy - qw * qz), 2 * (qx * qz + qw * qy),
    2 * (qx * qy + qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz - qw * qx),
    2 * (qx * qz - qw * qy), 2 * (qy * qz + qw * qx), 1 - 2 * (qx * qx + qy * qy))
  FROM ordered ORDER BY revision;
DROP TABLE temp.ordered;
DROP TABLE edits_1;
DROP TABLE transforms;
)sql",
    // The first release took any time; a map file takes none before 1970.
    R"sql(
UPDATE corrections SET utime = 0 WHERE utime < 0;
)sql",
    R"sql(
ALTER TABLE zones ADD COLUMN margin REAL NOT NULL DEFAULT 0;
ALTER TABLE zones ADD COLUMN cost INTEGER NOT NULL DEFAULT 0;
)sql",
};

}  // namespace concord
