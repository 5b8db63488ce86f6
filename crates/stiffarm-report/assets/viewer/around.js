// Limits on places, and what of a cell must be seen.

/** Lines of the limits. */
function limitLines(picture) {
  const { tool_box: box, keep_out: keep, wrist_height: wrist, floor } = picture.data.limits;
  const [low, high] = picture.data.extent;
  const pieces = [];
  if (box) {
    // Sides far beyond the picture are not drawn there.
    const clip = (v, i) => Math.min(Math.max(v, low[i] - 0.3 * picture.size), high[i] + 0.3 * picture.size);
    pieces.push(...boxLines(box.map((corner) => corner.map(clip))));
  }
  if (keep) {
    const [origin, axis] = [vec(keep.origin), vec(keep.axis)];
    for (const z of [low[2], (low[2] + high[2]) / 2, high[2]]) {
      const along = (z - origin.z) / (axis.z || 1);
      pieces.push(...circleLines(origin.clone().addScaledVector(axis, along), axis, keep.radius));
    }
  }
  for (const z of [wrist, floor]) {
    if (z === null || z === undefined || Math.abs(z - picture.floor.z) < 1e-6) continue;
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]];
    pushLine(pieces, corners.map(([x, y]) => new Vector3((x ? high : low)[0], (y ? high : low)[1], z)));
  }
  return pieces;
}

/** Names of the limits on places, in a corner of each. */
function limitLabels(picture) {
  const { tool_box: box, keep_out: keep, wrist_height: wrist, floor } = picture.data.limits;
  const [low, high] = picture.data.extent;
  if (box) picture.label(vec(high.map((v, i) => Math.min(v + 0.3 * picture.size, box[1][i]))), 'box for the tool', 'limit');
  if (keep) picture.label(new Vector3(keep.origin[0], keep.origin[1] - keep.radius, high[2]), 'keep-out', 'limit');
  const corner = (z) => new Vector3(low[0], low[1], z);
  if (wrist !== null) picture.label(corner(wrist), 'lowest wrist', 'limit');
  if (floor !== null) picture.label(corner(floor), 'lowest tool point', 'limit');
}

/** Most postures whose arm is seen with its thickness; of more, lines along the arms are enough. */
const THICK = 200;

/**
 * Points that must be seen: arm, tool, measuring points, loads and arrows in every posture, what stands around, stations
 * that are near.
 */
function seenPoints(picture) {
  const { data } = picture;
  const points = [];
  const [low, high] = data.extent.map(vec);
  const corners = cornersOf(picture);
  const count = data.groups.reduce((sum, group) => sum + group.postures.length, 0);
  for (const { body, at } of corners) if (body.kind === 'standing') points.push(...at.map((p) => p.clone().clamp(low, high)));
  data.groups.forEach((group) => group.postures.forEach((posture, p) => {
    const frames = framesOf(data, posture, null, 0);
    const flange = frames[frames.length - 1];
    points.push(...armLine(frames, vec(data.loads[0].at).applyMatrix4(flange)));
    points.push(...data.measuring_points.map((point) => vec(point.at).applyMatrix4(flange)));
    posture.loads.forEach(({ force }, load) => {
      const loading = vec(data.loads[Math.min(load, data.loads.length - 1)].at).applyMatrix4(flange);
      points.push(loading.clone().addScaledVector(vec(force).normalize(), data.force_length), loading);
    });
    for (const { body, at } of corners) {
      const isSeen = body.kind === 'tool' || (body.kind === 'arm' && (count <= THICK || p === 0));
      const frame = frames[Math.min(body.carrier, frames.length - 1)];
      if (isSeen) points.push(...at.map((corner) => corner.clone().applyMatrix4(frame)));
    }
  }));
  for (const { at, vector } of data.arrows?.arrows || []) points.push(vec(at).addScaledVector(vec(vector), picture.residualTimes));
  points.push(...(data.path?.points || []).map(vec));
  for (const load of data.loads) if (load.anchor) points.push(vec(load.anchor));
  for (const { at: place } of data.stations) if (place.every((v, i) => v >= data.extent[0][i] && v <= data.extent[1][i])) points.push(vec(place));
  return points.length ? points : [low, high];
}

/** The corners of a box around each solid of each body, in the frame of its carrier. */
function cornersOf(picture) {
  return picture.groups.map((group) => {
    const at = [];
    for (const { geometry } of group.children) {
      if (geometry.type === 'PlaneGeometry') continue;
      geometry.computeBoundingBox();
      const { min, max } = geometry.boundingBox;
      for (let i = 0; i < 8; i += 1) at.push(new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z));
    }
    return { body: group.userData.body, at };
  });
}
