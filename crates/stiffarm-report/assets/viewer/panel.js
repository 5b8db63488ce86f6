// Controls around the picture, and what is told of the posture shown. Names from the data are only ever text.

/** An element with properties, attributes (data-…, aria-…) and children. */
function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes('-') || name === 'role' || name === 'for') element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

const millimetres = (metres) => {
  const mm = metres * 1e3;
  return `${mm.toFixed(Math.abs(mm) < 10 ? 3 : 1)} mm`;
};
const minus = (text) => text.replace(/-/g, '\u2212');

class Panel {
  /** `act`: what the controls do, by name. */
  constructor(id, data, state, act) {
    Object.assign(this, { id, data, state, act });
    this.controls = make('div', { className: 'scene-controls' });
    this.info = make('div', { className: 'scene-info', role: 'group', 'aria-label': 'The posture shown' });
    this.addSteps();
    this.addViews();
    this.addDeflection();
    this.addGroups();
    this.addToggles();
  }

  addSteps() {
    this.select = make('select', { 'data-control': 'posture' });
    this.data.groups.forEach((group, g) => {
      const options = group.postures.map((posture, p) => make('option', { value: `${g}-${p}`, textContent: posture.name }));
      this.select.append(make('optgroup', { label: group.name }, ...options));
    });
    this.select.addEventListener('change', () => this.act.go(...this.select.value.split('-').map(Number)));
    const button = (step, sign, words) => {
      const one = make('button', { type: 'button', 'data-step': step, 'aria-label': words, textContent: sign });
      one.addEventListener('click', () => this.act.step(step === 'next' ? 1 : -1));
      return one;
    };
    this.controls.append(make('div', { className: 'scene-row scene-steps' },
      button('previous', '\u2039', 'Previous posture'),
      make('label', {}, make('span', { textContent: 'Posture' }), this.select),
      button('next', '\u203a', 'Next posture')));
    if (this.data.loads.length > 1) {
      const loads = this.data.loads.map((load, i) => make('option', { value: String(i), textContent: load.name }));
      const select = make('select', { 'data-control': 'load' }, ...loads);
      select.addEventListener('change', () => this.act.set({ load: Number(select.value) }));
      this.controls.append(make('div', { className: 'scene-row' }, make('label', {}, make('span', { textContent: 'Load' }), select)));
    }
  }

  addViews() {
    const row = make('div', { className: 'scene-row', role: 'group', 'aria-label': 'View' });
    this.views = Object.entries(VIEWS).map(([view, { words }]) => {
      const button = make('button', { type: 'button', 'data-view': view, textContent: words });
      button.addEventListener('click', () => this.act.look(view));
      row.append(button);
      return button;
    });
    this.controls.append(row);
  }

  addDeflection() {
    if (!this.state.most) return;
    this.slider = make('input', {
      type: 'range', 'data-control': 'deflection', id: `${this.id}-deflection`, min: '0', max: String(this.state.most),
      step: String(this.state.most / 100), value: '0',
    });
    this.times = make('output', { htmlFor: this.slider.id });
    this.slider.addEventListener('input', () => this.act.set({ exaggeration: Number(this.slider.value) }));
    this.controls.append(make('div', { className: 'scene-row scene-slider' },
      make('label', { for: this.slider.id, textContent: 'Deflection \u00d7' }), this.slider, this.times));
  }

  addGroups() {
    if (!this.data.groups.length) return;
    const boxes = this.data.groups.map((group, g) => {
      const box = make('input', { type: 'checkbox', 'data-group-toggle': String(g), checked: this.state.shown.includes(g) });
      box.addEventListener('change', () => this.act.toggleGroup(g, box.checked));
      const swatch = make('span', { className: 'scene-swatch', 'aria-hidden': 'true' });
      return make('label', { className: 'scene-check' }, box, swatch, make('span', { textContent: group.name }));
    });
    this.boxes = boxes.map((label) => label.querySelector('input'));
    this.swatches = boxes.map((label) => label.querySelector('.scene-swatch'));
    this.controls.append(make('fieldset', { className: 'scene-set' }, make('legend', { textContent: 'Other postures as lines' }), ...boxes));
  }

  addToggles() {
    const { data } = this;
    const standing = data.bodies.some((body) => body.kind === 'standing');
    const limits = Object.values(data.limits).some((limit) => limit !== null);
    const near = data.groups.some((group) => group.postures.some((posture) => posture.closest));
    const known = {
      labels: ['Labels', true],
      standing: ['Obstacles', standing],
      limits: ['Limits', limits],
      sight: ['Lines of sight', data.stations.length > 0],
      near: ['Closest pair', near],
      path: [data.path?.name || 'Path', Boolean(data.path)],
      arrows: [data.arrows?.label || 'Arrows', Boolean(data.arrows)],
      ellipsoid: ['Ellipsoid', Boolean(data.ellipsoids)],
    };
    const boxes = Object.entries(known).filter(([, [, has]]) => has).map(([name, [words]]) => {
      const box = make('input', { type: 'checkbox', 'data-toggle': name, checked: this.state.show[name] });
      box.addEventListener('change', () => this.act.show(name, box.checked));
      return make('label', { className: 'scene-check' }, box, make('span', { textContent: words }));
    });
    this.controls.append(make('fieldset', { className: 'scene-set' }, make('legend', { textContent: 'Show' }), ...boxes));
  }

  /** Brings controls and text to the state. */
  update() {
    const { state, data } = this;
    this.select.value = `${state.group}-${state.posture}`;
    if (this.slider) {
      this.slider.value = String(state.exaggeration);
      this.times.textContent = `\u00d7 ${Number(state.exaggeration.toPrecision(3))}`;
    }
    for (const button of this.views) button.setAttribute('aria-pressed', String(button.dataset.view === state.view));
    this.boxes?.forEach((box, g) => { box.checked = state.shown.includes(g); });
    this.swatches?.forEach((swatch, g) => { swatch.style.background = this.act.colour(g); });
    const group = data.groups[state.group];
    const posture = group?.postures[state.posture];
    this.info.replaceChildren(...(posture ? this.told(group, posture) : []));
  }

  told(group, posture) {
    const { data, state } = this;
    const load = posture.loads[state.load];
    const kind = data.loads[state.load];
    const list = make('dl');
    const row = (term, ...said) => list.append(make('dt', { textContent: term }), make('dd', {}, ...said));
    const angles = posture.angles_deg.map((angle, j) => make('span', {},
      make('span', { className: 'scene-joint', textContent: `${data.joints[j]} ` }), minus(`${angle.toFixed(1)}\u00b0`)));
    row('Angles', '');
    list.lastChild.className = 'scene-angles';
    list.lastChild.replaceChildren(...angles);
    if (load) {
      const force = Math.hypot(...load.force);
      const moment = Math.hypot(...load.moment);
      const parts = minus(`(${load.force.map((f) => f.toFixed(0)).join(', ')}) N`);
      const turning = moment > 1e-9 ? `; ${moment.toFixed(1)} N\u00b7m about its point` : '';
      const name = kind.name && kind.name !== kind.kind ? `${kind.name}: ` : '';
      row('Load', `${name}${kind.kind}, ${force.toFixed(0)} N = ${parts}${turning}`);
      if (load.deflection?.length) row('Deflection', this.deflection(load), data.loaded ? null : make('small', { textContent: `from the joints, ${data.model} model` }));
    }
    if (posture.closest) {
      const { names, distance } = posture.closest;
      const sign = distance < 0 ? ' (they overlap)' : '';
      row('Closest', `${names[0]} and ${names[1]}: ${minus((distance * 1e3).toFixed(0))} mm${sign}`);
    }
    if (posture.seen) {
      const names = (points) => points.map((i) => data.measuring_points[i].name).join(', ') || 'nothing';
      row('Seen', ...posture.seen.map((points, i) => make('span', { className: 'scene-line', textContent: `from ${data.stations[i].name}: ${names(points)}` })));
    }
    if (posture.room && !posture.violated) row('Least room', posture.room);
    const here = (one) => one.group === state.group && one.posture === state.posture;
    const ellipsoid = data.ellipsoids?.find(here);
    if (ellipsoid) row('Ellipsoid', ellipsoid.text);
    const rest = data.arrows?.arrows.filter(here) || [];
    if (rest.length) {
      const lines = rest.map((a) => make('span', { className: 'scene-line', textContent: `${a.name}: ${(Math.hypot(...a.vector) * 1e6).toFixed(1)} \u00b5m` }));
      row(data.arrows.label, ...lines);
    }
    const cautions = (posture.violated || []).map((sentence) => make('li', { textContent: `\u26a0 ${sentence}` }));
    const count = `${state.posture + 1} of ${group.postures.length}`;
    const swatch = make('span', { className: 'scene-swatch', 'aria-hidden': 'true' });
    swatch.style.background = this.act.colour(state.group);
    return [
      make('p', { className: 'scene-name' }, make('strong', { textContent: `Posture ${posture.name}` }),
        make('span', { className: 'scene-of' }, swatch, `${group.name}, ${count}`)),
      cautions.length ? make('ul', { className: 'scene-cautions' }, ...cautions) : null,
      list,
    ].filter(Boolean);
  }

  deflection(load) {
    const sizes = load.deflection.map((d) => Math.hypot(...d));
    const most = sizes.slice(1).reduce((best, size, i) => (size > best[0] ? [size, i] : best), [-1, -1]);
    let said = `${this.data.loaded || 'loading point'} ${millimetres(sizes[0])}`;
    if (most[1] >= 0) said += `; of the measuring points ${this.data.measuring_points[most[1]].name} moves most, ${millimetres(most[0])}`;
    return said;
  }
}
