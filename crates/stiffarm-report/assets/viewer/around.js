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

/** Points that must be seen: the arm in every posture, the bodies at the first, loads, stations that are near. */
function seenPoints(picture) {
  const { data } = picture;
  const points = [];
  const at = vec(data.loads[0].at);
  for (const group of data.groups) {
    for (const posture of group.postures) {
      const frames = framesOf(data, posture, null, 0);
      const loading = at.clone().applyMatrix4(frames[frames.length - 1]);
      points.push(...armLine(frames, loading));
      for (const { force } of posture.loads) points.push(loading.clone().addScaledVector(vec(force).normalize(), data.force_length));
    }
  }
  const [low, high] = data.extent.map(vec);
  const add = (p, stands) => points.push(stands ? p.clamp(low, high) : p);
  const first = data.groups[0]?.postures[0];
  const frames = first && framesOf(data, first, null, 0);
  picture.groups.forEach((group) => {
    const { body } = group.userData;
    if (body.kind !== 'standing' && !frames) return;
    const frame = frames ? frames[Math.min(body.carrier, frames.length - 1)] : new Matrix4();
    for (const { geometry } of group.children) {
      if (geometry.type === 'PlaneGeometry') continue;
      geometry.computeBoundingBox();
      const { min, max } = geometry.boundingBox;
      for (let i = 0; i < 8; i += 1) {
        const corner = new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z);
        add(corner.applyMatrix4(frame), body.kind === 'standing');
      }
    }
  });
  for (const load of data.loads) if (load.anchor) points.push(vec(load.anchor));
  for (const { at: place } of data.stations) if (place.every((v, i) => v >= data.extent[0][i] && v <= data.extent[1][i])) points.push(vec(place));
  return points.length ? points : [low, high];
}
