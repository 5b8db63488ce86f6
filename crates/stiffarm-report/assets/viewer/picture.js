// The three-dimensional picture of a scene in one state.

/** Style properties that the picture takes its colours from. */
const COLOURS = [
  'background', 'arm', 'arm-2', 'tool', 'standing', 'caution', 'ghost', 'grid', 'limit', 'load', 'sight', 'hidden',
  'near', 'point', 'residual', 'ink',
];

/** Most postures of a group that are drawn as lines with their names. */
const MOST_NAMED = 24;

/** True where the browser draws without a graphics card. */
function isSoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return false;
  const told = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

class Picture {
  constructor(data, canvas, container) {
    this.data = data;
    this.container = container;
    this.ratio = Math.min(window.devicePixelRatio || 1, 2);
    // Without a graphics card smooth edges cost half the time of a step: there they wait until nothing moves.
    this.isQuick = isSoftware();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.isQuick });
    this.renderer.setPixelRatio(this.isQuick ? 1 : this.ratio);
    this.world = new THREE.Scene();
    this.size = Math.hypot(...data.extent[0].map((low, i) => data.extent[1][i] - low));
    this.addLights();
    this.addFloor();
    this.materials = {};
    this.addBodies();
    this.addLines();
    this.addPoints();
    this.addExtras();
    this.readColours();
  }

  addLights() {
    const sky = new THREE.HemisphereLight(0xffffff, 0x8a93a0, 1.9);
    sky.position.set(0, 0, 1);
    const sun = new THREE.DirectionalLight(0xffffff, 1.7);
    sun.position.set(0.6, -1, 1.2);
    this.world.add(sky, sun);
  }

  /** Meshes of all bodies; each body has a material of its own, because a limit may be violated at it alone. */
  addBodies() {
    this.groups = [];
    this.ghosts = [];
    this.middles = [];
    const ghost = { transparent: true, opacity: 0.22, depthWrite: false };
    this.materials.ghost = new THREE.MeshLambertMaterial(ghost);
    for (const body of this.data.bodies) {
      const material = new THREE.MeshLambertMaterial();
      const [group, shadow] = [new THREE.Group(), new THREE.Group()];
      group.userData = { material, body };
      group.matrixAutoUpdate = false;
      shadow.matrixAutoUpdate = false;
      for (const solid of body.solids) {
        const shape = geometryOf(solid);
        if (!shape) {
          group.add(this.wall(solid, material));
          continue;
        }
        group.add(new THREE.Mesh(shape, material));
        if (body.kind !== 'standing') shadow.add(new THREE.Mesh(shape, this.materials.ghost));
      }
      this.groups.push(group);
      this.ghosts.push(shadow);
      this.middles.push(body.solids.map(middleOf).find(Boolean) || null);
      this.world.add(group, shadow);
    }
  }

  /** The piece of a plane within what is seen, seen through; level floors are the grid's. */
  wall(solid, material) {
    const normal = vec(solid.normal);
    const mesh = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), material);
    material.transparent = true;
    material.opacity = 0.18;
    material.side = THREE.DoubleSide;
    material.depthWrite = false;
    const [low, high] = this.data.extent.map(vec);
    const middle = low.clone().add(high).multiplyScalar(0.5);
    const off = middle.clone().sub(vec(solid.point)).dot(normal);
    mesh.position.copy(middle).addScaledVector(normal, -off);
    mesh.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    if (normal.z > 0.999) {
      const { floor } = this;
      mesh.scale.set(floor.high[0] - floor.low[0], floor.high[1] - floor.low[1], 1);
      mesh.position.set((floor.high[0] + floor.low[0]) / 2, (floor.high[1] + floor.low[1]) / 2, floor.z - 0.001 * this.size);
    } else {
      mesh.scale.setScalar(this.size * 0.8);
    }
    mesh.visible = Math.abs(off) < this.size;
    return mesh;
  }

  addFloor() {
    const [low, high] = this.data.extent.map(vec);
    const planes = this.data.bodies.filter((b) => b.kind === 'standing').flatMap((b) => b.solids);
    const level = planes.find((s) => s.kind === 'plane' && s.normal[2] > 0.999);
    const z = level ? level.point[2] : this.data.limits.floor ?? Math.min(0, low.z);
    this.step = niceBelow(Math.max(high.x - low.x, high.y - low.y) / 7);
    this.floor = { z, ...gridLines(low, high, z, this.step) };
    this.grid = new ThinLines();
    this.grid.set(this.floor.pieces);
    this.grid.object.visible = true;
    this.triad = [0, 1, 2].map((k) => {
      const arrow = new ArrowMesh(new THREE.MeshBasicMaterial({ color: ['#c0392b', '#1e8449', '#2471a3'][k], depthTest: false }));
      arrow.shaft.renderOrder = 2;
      arrow.head.renderOrder = 2;
      const tip = new Vector3().setComponent(k, 0.09 * this.size);
      arrow.set(new Vector3(), tip, 0.0028 * this.size);
      this.world.add(arrow.group);
      return tip;
    });
    this.world.add(this.grid.object);
  }

  addLines() {
    const add = (name, width, options) => {
      this[name] = new Lines(width, options);
      this.world.add(this[name].object);
    };
    add('limit', 1.5, { dashed: true, dashSize: 0.02 * this.size, gapSize: 0.014 * this.size });
    add('rope', 2.2);
    add('tool', 1.6);
    add('spine', 1.6);
    add('sight', 1.6);
    add('hidden', 1.6, { dashed: true, dashSize: 0.014 * this.size, gapSize: 0.014 * this.size });
    add('near', 3.5);
    this.near.material.depthTest = false;
    const many = this.data.groups.reduce((sum, group) => sum + group.postures.length, 0) > 100;
    this.others = this.data.groups.map(() => {
      const lines = many ? new ThinLines() : new Lines(1.4);
      this.world.add(lines.object);
      return lines;
    });
    this.limit.set(limitLines(this));
  }

  addPoints() {
    const ball = new THREE.SphereGeometry(0.0075 * this.size, 16, 12);
    this.materials.point = new THREE.MeshLambertMaterial();
    this.materials.load = new THREE.MeshLambertMaterial();
    const mesh = (material) => {
      const one = new THREE.Mesh(ball, material);
      this.world.add(one);
      return one;
    };
    this.points = this.data.measuring_points.map(() => mesh(this.materials.point));
    this.loadingPoint = mesh(this.materials.load);
    this.anchor = mesh(this.materials.load);
    this.materials.station = new THREE.MeshLambertMaterial();
    this.stations = this.data.stations.map((station) => {
      const one = mesh(this.materials.station);
      one.position.copy(vec(station.at));
      one.scale.setScalar(1.6);
      return one;
    });
    this.force = new ArrowMesh(this.materials.load);
    this.world.add(this.force.group);
  }

  addExtras() {
    const { path, arrows, ellipsoids } = this.data;
    if (path) {
      this.path = new Lines(5, { vertexColors: true });
      this.pathAtRest = new Lines(1.2, { transparent: true, opacity: 0.7 });
      this.pathCommanded = new Lines(2);
      this.world.add(this.path.object, this.pathAtRest.object, this.pathCommanded.object);
    }
    this.materials.residual = new THREE.MeshLambertMaterial();
    this.residuals = [];
    if (arrows) {
      const longest = Math.max(...arrows.arrows.map((a) => Math.hypot(...a.vector)), 1e-12);
      this.residualTimes = niceBelow((0.12 * this.size) / longest);
    }
    if (ellipsoids) {
      const material = new THREE.MeshLambertMaterial({ transparent: true, opacity: 0.4, depthWrite: false });
      this.materials.ellipsoid = material;
      this.ellipsoid = new THREE.Mesh(new THREE.SphereGeometry(1, 32, 24), material);
      this.ellipsoid.matrixAutoUpdate = false;
      this.ellipsoid.visible = false;
      this.world.add(this.ellipsoid);
      this.ellipsoidTimes = (0.12 * this.size) / Math.max(...ellipsoids.flatMap((e) => e.half), 1e-300);
    }
  }

  /** Takes the colours from the style of the page. */
  readColours() {
    const style = getComputedStyle(this.container);
    const colour = {};
    for (const name of COLOURS) colour[name] = style.getPropertyValue(`--scene-${name}`).trim() || '#888888';
    this.colour = colour;
    this.renderer.setClearColor(colour.background);
    for (const [lines, name] of [
      ['grid', 'grid'], ['limit', 'limit'], ['rope', 'load'], ['tool', 'tool'], ['spine', 'arm-2'], ['sight', 'sight'],
      ['hidden', 'hidden'], ['near', 'near'],
    ]) this[lines].material.color.set(colour[name]);
    for (const name of ['point', 'load', 'residual', 'ghost']) this.materials[name].color.set(colour[name]);
    this.materials.station.color.set(colour.sight);
    if (this.materials.ellipsoid) this.materials.ellipsoid.color.set(colour.residual);
    this.pathAtRest?.material.color.set(colour.limit);
    this.pathCommanded?.material.color.set(colour.point);
    this.others.forEach((lines, i) => lines.material.color.set(this.groupColour(i)));
  }

  /** The colour of a group on the page: dark ones would hardly be seen on a dark one. */
  groupColour(i) {
    const own = new Color(this.data.groups[i].colour);
    if (new Color(this.colour.background).getHSL({}).l > 0.4) return own.getStyle();
    if (own.getHSL({}).l < 0.1) return this.colour.ink;
    return own.lerp(new Color('#ffffff'), 0.2).getStyle();
  }

  /** Moves everything to where it is in `state`. */
  update(state) {
    const { data } = this;
    const posture = data.groups[state.group]?.postures[state.posture];
    this.labels = [];
    this.updateOthers(state);
    if (!posture) return;
    const load = posture.loads[state.load];
    const at = vec(data.loads[Math.min(state.load, data.loads.length - 1)].at);
    const frames = framesOf(data, posture, load?.turns, state.exaggeration);
    const rest = state.exaggeration ? framesOf(data, posture, null, 0) : frames;
    this.updateBodies(state, posture, frames, rest);
    const flange = frames[frames.length - 1];
    const loading = at.clone().applyMatrix4(flange);
    const measured = data.measuring_points.map((p) => vec(p.at).applyMatrix4(flange));
    const tool = [];
    const origin = new Vector3().setFromMatrixPosition(flange);
    for (const p of [...measured, loading]) pushLine(tool, [origin, p]);
    this.tool.set(tool);
    measured.forEach((p, i) => {
      this.points[i].position.copy(p);
      this.label(p, data.measuring_points[i].name, 'point');
    });
    this.updateLoad(state, load, loading);
    this.updateSight(state, posture, measured);
    this.near.set([]);
    if (posture.closest && state.show.near) {
      const ends = posture.closest.points.map(vec);
      this.near.set(ends.flatMap((p) => p.toArray()));
      const middle = ends[0].clone().add(ends[1]).multiplyScalar(0.5);
      this.label(middle, `${(posture.closest.distance * 1e3).toFixed(0)} mm`, 'near');
    }
    // What is fixed to the tool goes where the deflection takes it.
    const moved = flange.clone().multiply(rest[rest.length - 1].clone().invert());
    this.updateExtras(state, moved);
    this.triad.forEach((tip, k) => this.label(tip, 'xyz'[k], 'axis'));
    if (state.show.limits) limitLabels(this);
    this.limit.object.visible = state.show.limits && this.limit.object.geometry.instanceCount > 0;
  }

  label(at, text, kind) {
    this.labels.push({ at, text, kind });
  }

  updateBodies(state, posture, frames, rest) {
    const red = new Set(posture.caution || []);
    this.groups.forEach((group, i) => {
      const { body, material } = group.userData;
      const last = frames.length - 1;
      const number = Math.min(body.carrier, last);
      group.matrix.copy(frames[number]);
      group.visible = body.kind !== 'standing' || state.show.standing;
      const plain = { tool: 'tool', standing: 'standing' }[body.kind] || (number % 2 ? 'arm-2' : 'arm');
      material.color.set(this.colour[red.has(i) ? 'caution' : plain]);
      this.ghosts[i].matrix.copy(rest[number]);
      this.ghosts[i].visible = rest !== frames && body.carrier > 0;
      const middle = this.middles[i];
      if (middle && (red.has(i) || (body.kind === 'standing' && state.show.standing))) {
        this.label(middle.clone().applyMatrix4(frames[number]), body.name, red.has(i) ? 'caution' : 'standing');
      }
    });
    // Where everything is too near to everything, the sentences beside the picture name it.
    const cautions = this.labels.filter((label) => label.kind === 'caution');
    if (cautions.length > 3) this.labels = this.labels.filter((label) => label.kind !== 'caution' || cautions.indexOf(label) < 3);
    const spine = [];
    if (rest !== frames) pushLine(spine, armLine(rest, new Vector3().setFromMatrixPosition(rest[rest.length - 1])));
    this.spine.set(spine);
  }

  updateLoad(state, load, loading) {
    const kind = this.data.loads[state.load];
    this.loadingPoint.position.copy(loading);
    this.anchor.visible = Boolean(kind?.anchor);
    this.rope.set([]);
    this.force.group.visible = false;
    if (kind?.anchor) {
      const anchor = vec(kind.anchor);
      this.anchor.position.copy(anchor);
      this.rope.set([...loading.toArray(), ...anchor.toArray()]);
      this.label(anchor, kind.name ? `anchor, ${kind.name}` : 'anchor', 'load');
    }
    const force = load && vec(load.force);
    if (force?.length() > 0) {
      const tip = loading.clone().addScaledVector(force.clone().normalize(), this.data.force_length);
      this.force.set(loading, tip, 0.0042 * this.size);
      this.label(tip, `${force.length().toFixed(0)} N`, 'load');
    }
  }

  updateSight(state, posture, measured) {
    const [seen, hidden] = [[], []];
    this.data.stations.forEach((station, i) => {
      this.stations[i].visible = state.show.sight;
      if (!state.show.sight) return;
      this.label(vec(station.at), station.name, 'sight');
      measured.forEach((p, k) => {
        pushLine(posture.seen?.[i]?.includes(k) ? seen : hidden, [vec(station.at), p]);
      });
    });
    this.sight.set(seen);
    this.hidden.set(hidden);
  }

  /** Arms of the groups that are shown, as lines, but for the posture in full. */
  updateOthers(state) {
    const at = vec(this.data.loads[0].at);
    this.data.groups.forEach((group, g) => {
      const full = state.group === g ? state.posture : -1;
      const key = `${state.shown.includes(g)} ${full}`;
      if (this.others[g].key === key) return;
      this.others[g].key = key;
      const pieces = [];
      if (state.shown.includes(g)) {
        this.otherLines ??= [];
        this.otherLines[g] ??= group.postures.map((posture) => {
          const frames = framesOf(this.data, posture, null, 0);
          const own = [];
          pushLine(own, armLine(frames, at.clone().applyMatrix4(frames[frames.length - 1])));
          return own;
        });
        this.otherLines[g].forEach((own, p) => {
          if (p !== full) pieces.push(...own);
        });
      }
      this.others[g].set(pieces);
    });
    this.data.groups.forEach((group, g) => {
      if (!state.shown.includes(g) || group.postures.length > MOST_NAMED) return;
      group.postures.forEach((posture, p) => {
        if (state.group === g && state.posture === p) return;
        this.label(vec(this.otherLines[g][p].slice(-3)), `posture ${posture.name}`, 'other');
      });
    });
  }

  /** `moved`: from where the flange is without load to where it is drawn. */
  updateExtras(state, moved) {
    const { path, arrows, ellipsoids } = this.data;
    const isHere = (one) => one.group === state.group && one.posture === state.posture;
    if (path) {
      const rest = path.points.map(vec);
      const shifted = (by) => rest.map((p, i) => (by[i] ? p.clone().addScaledVector(vec(by[i]), state.exaggeration) : p));
      const bent = shifted(path.deflection);
      const [low, high] = path.range;
      const colours = [];
      const colour = (i) => scaleColour((path.size[i] - low) / (high - low || 1)).toArray();
      for (let i = 1; i < bent.length; i += 1) colours.push(...colour(i - 1), ...colour(i));
      const [pieces, own, commanded] = [[], [], []];
      pushLine(pieces, bent);
      pushLine(own, rest);
      if (path.correction.length) pushLine(commanded, shifted(path.correction));
      this.path.set(state.show.path ? pieces : [], colours);
      this.pathAtRest.set(state.show.path && state.exaggeration ? own : []);
      this.pathCommanded.set(state.show.path && state.exaggeration ? commanded : []);
      if (state.show.path && rest.length) this.label(bent[0], path.names[0] || path.name, 'point');
    }
    if (arrows) {
      const here = state.show.arrows ? arrows.arrows.filter(isHere) : [];
      while (this.residuals.length < here.length) {
        const arrow = new ArrowMesh(this.materials.residual);
        this.residuals.push(arrow);
        this.world.add(arrow.group);
      }
      this.residuals.forEach((arrow, i) => {
        arrow.group.visible = i < here.length;
        if (i >= here.length) return;
        const from = vec(here[i].at).applyMatrix4(moved);
        arrow.set(from, from.clone().addScaledVector(vec(here[i].vector), this.residualTimes), 0.003 * this.size);
      });
    }
    if (ellipsoids) {
      const here = state.show.ellipsoid && ellipsoids.find(isHere);
      this.ellipsoid.visible = Boolean(here);
      if (here) {
        const axes = here.axes.map((axis, k) => vec(axis).multiplyScalar(here.half[k] * this.ellipsoidTimes));
        this.ellipsoid.matrix.makeBasis(...axes).setPosition(vec(here.centre).applyMatrix4(moved));
      }
    }
  }

  resize(width, height) {
    this.renderer.setSize(width, height, false);
  }

  draw(camera) {
    if (this.isFine) this.renderer.setPixelRatio(1);
    this.isFine = false;
    this.renderer.render(this.world, camera);
  }

  /** Draws once with smooth edges, where the other pictures have none. */
  drawFine(camera) {
    this.renderer.setPixelRatio(2);
    this.draw(camera);
    this.isFine = true;
  }

  /** Waits until the picture is really drawn. */
  finish() {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
}
