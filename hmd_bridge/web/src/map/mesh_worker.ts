/** Runs in a worker: blocks come, their meshes go. */
import { doJob, type MeshJob } from "./mesh_job";

self.onmessage = ({ data }: MessageEvent<MeshJob>): void => {
  const done = doJob(data);
  self.postMessage(done, { transfer: [done.corners.buffer, done.indices.buffer] });
};
