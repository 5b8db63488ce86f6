// One scene of a page: its state, and what controls, keys and the page's style do to it.

const HINT = 'Drag to turn, Shift and drag to move, wheel to zoom; on a phone tap the picture first, or use two fingers.'
  + ' Keys, after a click into the picture or beside it, or with Tab on a control: arrows turn, + and \u2212 zoom, Home resets,'
  + ' N and P step. In a list or on a slider, arrows and Home are its own.';

class View {
  constructor(container, data) {
    Object.assign(this, { container, data, frameMs: 0, pending: false });
    this.state = {
      group: 0, posture: firstCaution(data), load: 0, exaggeration: 0, shown: data.groups.length ? [0] : [], view: 'perspective',
      most: this.mostExaggeration(),
      show: { labels: true, standing: true, limits: true, sight: true, near: true, path: true, arrows: true, ellipsoid: true },
    };
    const title = container.dataset.title || data.cell;
    this.canvas = make('canvas', { role: 'img', 'aria-label': `${title}: the cell in three dimensions` });
    this.stage = make('div', { className: 'scene-stage', tabIndex: 0, role: 'group', 'aria-label': `${title}. ${HINT}` }, this.canvas);
    // Throws where the browser has no WebGL; nothing of the page has changed before.
    this.picture = new Picture(data, this.canvas, container);
    this.labels = new Labels(this.stage);
    this.status = make('p', { className: 'scene-status', role: 'status' });
    this.scale = make('p', { className: 'scene-scale', textContent: `Grid ${Number((this.picture.step * 1e3).toPrecision(3))} mm` });
    this.stage.append(this.status, this.scale);
    this.panel = new Panel(container.id, data, this.state, {
      go: (group, posture) => this.set({ group, posture }),
      step: (by) => this.step(by),
      look: (view) => this.look(view),
      set: (change) => this.set(change),
      show: (name, on) => this.set({ show: { ...this.state.show, [name]: on } }),
      toggleGroup: (group, on) => this.toggleGroup(group, on),
      colour: (group) => this.picture.groupColour(group),
    });
    const notes = [make('p', { className: 'scene-hint', textContent: HINT })];
    if (data.shapes === 'tubes') {
      notes.unshift(make('p', { className: 'scene-hint', textContent: 'No shapes of this arm are known: the tubes show its joints and proportions, not its castings.' }));
    }
    // A click anywhere in the block gives it the focus, and the keys with it.
    this.body = make('div', { className: 'scene-body', tabIndex: -1 },
      make('div', { className: 'scene-picture' }, this.stage, this.legend()), this.panel.info, this.panel.controls, ...notes);
    container.append(this.body);
    container.classList.add('scene-live');
    this.orbit = new Orbit(seenPoints(this.picture), data.first_turn);
    this.listen();
    this.resize();
    this.set({});
  }

  /** So that the largest deflection can be seen well, and not much more. */
  mostExaggeration() {
    const sizes = this.data.groups.flatMap((g) => g.postures).flatMap((p) => p.loads).flatMap((l) => (l.turns && l.deflection) || []);
    const { deflection = [], correction = [] } = this.data.path || {};
    const largest = [...sizes, ...deflection, ...correction].reduce((most, d) => Math.max(most, Math.hypot(...d)), 0);
    const [low, high] = this.data.extent;
    const size = Math.hypot(...low.map((v, i) => high[i] - v));
    return largest > 0 ? niceBelow(Math.max((0.12 * size) / largest, 1)) : 0;
  }

  /** The colours of the path, with their unit. */
  legend() {
    const { path, arrows } = this.data;
    const rows = [];
    if (path) {
      const bar = make('span', { className: 'scene-bar', 'aria-hidden': 'true' });
      bar.style.background = `linear-gradient(90deg, ${SCALE.join(', ')})`;
      const [low, high] = path.range.map((v) => Number(v.toPrecision(3)));
      rows.push(make('p', {}, `${path.label} along ${path.name}: ${low} ${path.unit} `, bar, ` ${high} ${path.unit}`));
      if (path.correction.length) {
        const swatch = make('span', { className: 'scene-swatch', 'aria-hidden': 'true' });
        swatch.style.background = 'var(--scene-point)';
        rows.push(make('p', {}, swatch, ` ${path.name} as commanded`));
      }
    }
    if (arrows) rows.push(make('p', { textContent: `${arrows.label}: arrows drawn \u00d7 ${this.picture.residualTimes}` }));
    return rows.length ? make('div', { className: 'scene-legend' }, ...rows) : null;
  }

  listen() {
    listen(this.stage, this.orbit, () => this.looked());
    this.container.addEventListener('keydown', (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(this.stage);
    const recolour = () => {
      this.picture.readColours();
      this.set({});
    };
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', recolour);
    new MutationObserver(recolour).observe(document.documentElement, { attributes: true, attributeFilter: ['data-theme'] });
    this.canvas.addEventListener('webglcontextlost', () => withoutPicture(this.container, 'The browser gave up drawing in three dimensions.'));
  }

  key(event) {
    if (event.altKey || event.ctrlKey || event.metaKey || event.target.tagName === 'SELECT') return;
    const steps = { n: 1, N: 1, p: -1, P: -1 };
    // A slider has arrows, Home and Page keys of its own.
    if (event.target.type !== 'range') Object.assign(steps, { PageDown: 1, PageUp: -1 });
    if (steps[event.key]) this.step(steps[event.key]);
    else if (event.target.type !== 'range' && moveByKey(this.orbit, event.key)) this.looked();
    else return;
    event.preventDefault();
  }

  /** The next posture in measuring order, from the last of a group to the first of the next. */
  step(by) {
    const all = this.data.groups.flatMap((group, g) => group.postures.map((_, p) => [g, p]));
    if (!all.length) return;
    const at = all.findIndex(([g, p]) => g === this.state.group && p === this.state.posture);
    const [group, posture] = all[(at + by + all.length) % all.length];
    this.set({ group, posture });
  }

  toggleGroup(group, on) {
    const shown = this.state.shown.filter((g) => g !== group);
    this.set({ shown: on ? [...shown, group].sort((a, b) => a - b) : shown });
  }

  look(view) {
    this.orbit.look(view);
    this.looked();
  }

  /** After the camera has moved. */
  looked() {
    this.state.view = this.orbit.view;
    for (const button of this.panel.views) button.setAttribute('aria-pressed', String(button.dataset.view === this.state.view));
    this.drawSoon();
  }

  set(change) {
    const start = performance.now();
    Object.assign(this.state, change);
    const { state, container } = this;
    this.picture.update(state);
    this.panel.update();
    this.labels.set(state.show.labels ? sorted(this.picture.labels) : []);
    this.status.textContent = this.words();
    container.dataset.group = String(state.group);
    container.dataset.posture = String(state.posture);
    container.dataset.exaggeration = String(state.exaggeration);
    container.dataset.shownGroups = state.shown.join(' ');
    this.spent = performance.now() - start;
    this.drawSoon();
  }

  /** What the slider does to the arm, in words. */
  words() {
    const { state, data } = this;
    const load = data.groups[state.group]?.postures[state.posture]?.loads[state.load];
    if (!load?.deflection?.length) return '';
    const drawn = state.exaggeration ? `, drawn \u00d7 ${Number(state.exaggeration.toPrecision(3))}` : '';
    const point = data.loaded ? `The ${data.loaded}` : 'Loading point';
    return `${point} moves ${millimetres(Math.hypot(...load.deflection[0]))}${drawn}`;
  }

  resize() {
    const [width, height] = [this.stage.clientWidth, this.stage.clientHeight];
    if (!width || !height || (this.width === width && this.height === height)) return;
    Object.assign(this, { width, height });
    this.picture.resize(width, height);
    this.orbit.resize(width, height);
    this.drawSoon();
  }

  /** Where the two lines of text stand in the picture's lower corners. */
  corners() {
    const { width, height } = this;
    const box = (element) => widthOf(element.textContent, 13, this.labels.family) + 18;
    const [left, right] = [Math.min(box(this.status), 0.65 * width), box(this.scale)];
    const top = height - (box(this.status) > left ? 46 : 28);
    return [[0, top, left, height], [width - right, height - 28, width, height]];
  }

  drawSoon() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.pending = false;
    if (!this.width) return;
    const start = performance.now();
    this.picture.draw(this.orbit.camera);
    this.labels.place(this.orbit.camera, this.width, this.height, this.corners());
    if (window.stiffarm.measure) this.picture.finish();
    this.frameMs = performance.now() - start + (this.spent || 0);
    this.spent = 0;
    this.container.dataset.ready = 'true';
    if (!this.picture.isQuick) return;
    clearTimeout(this.later);
    this.later = setTimeout(() => this.picture.drawFine(this.orbit.camera), 400);
  }
}

/** The first posture of the first group at which a limit is violated, else the first. */
function firstCaution(data) {
  const postures = data.groups[0]?.postures || [];
  return Math.max(postures.findIndex((posture) => posture.violated?.length), 0);
}

/** Labels, those that matter most first. */
function sorted(labels) {
  const order = ['caution', 'near', 'load', 'point', 'sight', 'axis', 'standing', 'other', 'limit'];
  return [...labels].sort((a, b) => order.indexOf(a.kind) - order.indexOf(b.kind));
}

/** Shows what the page brings for such browsers, and says why. */
function withoutPicture(container, why) {
  container.classList.remove('scene-live');
  container.querySelector('.scene-body')?.remove();
  const said = make('p', { className: 'scene-why', textContent: `${why} This picture stands still.` });
  container.prepend(said);
}

function start(container) {
  if (window.stiffarm.scenes[container.id]) return;
  const script = container.querySelector('script[type="application/json"]');
  const data = JSON.parse(script.textContent);
  try {
    window.stiffarm.scenes[container.id] = new View(container, { ...data, groups: data.groups || [] });
  } catch (error) {
    withoutPicture(container, 'This browser cannot draw in three dimensions (WebGL).');
    console.info(error);
  }
}

window.stiffarm = window.stiffarm || {};
window.stiffarm.scenes = window.stiffarm.scenes || {};
const startAll = () => document.querySelectorAll('.scene').forEach(start);
if (document.readyState === 'loading') document.addEventListener('DOMContentLoaded', startAll);
else startAll();
