'use strict';
// Images with a slider: as often on a page as there are scripts of class `pictures`.
function viewer(script, alone) {
  const data = JSON.parse(script.textContent), prefix = script.id.slice(0, -'data'.length);
  const pictures = data.pictures, $ = id => document.getElementById(prefix + id);
  if (!pictures.length) return 0;
  const { width, height } = pictures[0];

  // Half floats by table.
  const half = new Float32Array(65536);
  for (let h = 0; h < 65536; h++) {
    const s = h & 0x8000 ? -1 : 1, e = (h >> 10) & 31, m = h & 1023;
    half[h] = e === 31 ? (m ? NaN : s * Infinity) : s * (e ? 2 ** (e - 15) * (1 + m / 1024) : 2 ** -14 * (m / 1024));
  }
  for (const p of pictures) {
    const raw = atob(p.data), n = raw.length / 2;
    p.pixels = new Float32Array(n);
    for (let i = 0; i < n; i++) p.pixels[i] = half[raw.charCodeAt(2 * i) | (raw.charCodeAt(2 * i + 1) << 8)];
    p.data = null;
  }
  const reference = pictures[0].pixels;
  let sum = 0, count = 0;
  for (const x of reference) if (isFinite(x)) { sum += x; count++; }
  const meanR = sum / count, eps = 0.01 * meanR * meanR;

  // The state is all there is to draw; the address after # keeps it.
  const start = { left: 0, right: Math.min(1, pictures.length - 1), mode: 'split', ev: data.exposure, scale: 0, at: 0.5, zoom: 1, x: 0, y: 0 };
  const state = { ...start };
  for (const [k, v] of new URLSearchParams(alone ? location.hash.slice(1) : '')) {
    if (k === 'mode') { if (['split', 'difference', 'signed'].includes(v)) state.mode = v; }
    else if (k in start && isFinite(v) && v !== '') state[k] = +v;
  }
  const clamp = (x, a, b) => Math.min(Math.max(x, a), b);
  const index = i => clamp(Math.round(i), 0, pictures.length - 1);

  const canvas = $('view'), g = canvas.getContext('2d');
  for (const id of ['left', 'right']) {
    pictures.forEach((p, i) => $(id).add(new Option(`${i + 1}  ${p.name}`, i)));
  }

  // Images as they are shown, made when they are first asked for.
  const shown = new Map();
  const srgb = x => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
  const curve = new Uint8ClampedArray(4097);
  for (let i = 0; i <= 4096; i++) curve[i] = Math.round(255 * srgb((i / 4096) ** 2));
  const byte = x => x > 0 ? curve[Math.round(4096 * Math.sqrt(Math.min(x, 1)))] : 0;
  // Black, violet, orange, white.
  const heat = t => { t = clamp(t, 0, 1); return [255 * Math.sqrt(t), 255 * t ** 3, 255 * Math.max(Math.sin(2 * Math.PI * t), 0) * (t < 0.5 ? 1 : 0) + 255 * Math.max(0, (t - 0.85) / 0.15)]; };
  function render(i) {
    const key = [i, state.mode, state.ev, state.scale].join();
    if (shown.has(key)) return shown.get(key);
    if (shown.size > 12) shown.clear();
    const c = Object.assign(document.createElement('canvas'), { width, height });
    const target = new ImageData(width, height), out = target.data, px = pictures[i].pixels;
    const k = 2 ** state.ev, scale = 10 ** state.scale;
    for (let p = 0, q = 0; p < px.length; p += 3, q += 4) {
      let rgb, finite = isFinite(px[p] + px[p + 1] + px[p + 2]);
      if (!finite) rgb = [255, 0, 255];
      else if (state.mode === 'split') rgb = [byte(k * px[p]), byte(k * px[p + 1]), byte(k * px[p + 2])];
      else {
        let d = 0, l = 0;
        for (let c = 0; c < 3; c++) { const e = px[p + c] - reference[p + c], r = reference[p + c]; d += e * e / (r * r + eps); l += e / Math.sqrt(r * r + eps); }
        if (state.mode === 'difference') rgb = heat(Math.sqrt(d / 3) / scale);
        else { const t = clamp(l / 3 / scale, -1, 1); rgb = t > 0 ? [255, 255 * (1 - t), 255 * (1 - t)] : [255 * (1 + t), 255 * (1 + t), 255]; }
      }
      out[q] = rgb[0]; out[q + 1] = rgb[1]; out[q + 2] = rgb[2]; out[q + 3] = 255;
    }
    c.getContext('2d').putImageData(target, 0, 0);
    shown.set(key, c);
    return c;
  }

  let pointer = null;
  const fit = () => canvas.width / width * state.zoom;
  function draw() {
    state.left = index(state.left); state.right = index(state.right);
    state.ev = clamp(state.ev, -24, 24); state.scale = clamp(state.scale, -6, 2);
    state.zoom = clamp(state.zoom, 1, 64); state.at = clamp(state.at, 0, 1);
    const z = fit();
    state.x = clamp(state.x, 0, width - canvas.width / z); state.y = clamp(state.y, 0, Math.max(0, height - canvas.height / z));
    $('left').value = state.left; $('right').value = state.right; $('mode').value = state.mode;
    $('exposure').value = state.ev; $('ev').value = `${state.ev >= 0 ? '+' : ''}${state.ev.toFixed(2)} EV`;
    $('scale').value = state.scale; $('scale-value').value = `${(100 * 10 ** state.scale).toPrecision(3)} % is full`;
    $('scale-label').hidden = state.mode === 'split';
    g.imageSmoothingEnabled = z < 1;
    g.fillStyle = '#111'; g.fillRect(0, 0, canvas.width, canvas.height);
    const cut = Math.round(state.at * canvas.width);
    const part = (i, from, to) => {
      if (to <= from) return;
      g.save(); g.beginPath(); g.rect(from, 0, to - from, canvas.height); g.clip();
      g.drawImage(render(i), -state.x * z, -state.y * z, width * z, height * z);
      g.restore();
    };
    part(state.left, 0, cut); part(state.right, cut, canvas.width);
    g.fillStyle = '#fff'; g.fillRect(cut - 1, 0, 2, canvas.height);
    g.font = '14px system-ui, sans-serif'; g.textBaseline = 'top';
    const label = (text, x, align) => { g.textAlign = align; g.lineWidth = 3; g.strokeStyle = '#000'; g.strokeText(text, x, 8); g.fillText(text, x, 8); };
    label(pictures[state.left].name, 8, 'left'); label(pictures[state.right].name, canvas.width - 8, 'right');
    $('captions').replaceChildren(...[state.left, state.right].map(i => Object.assign(document.createElement('span'), { textContent: pictures[i].caption })));
    status();
    if (!alone) return; // the address keeps the state of one
    const keep = Object.entries(state).filter(([k, v]) => v !== start[k]).map(([k, v]) => `${k}=${typeof v === 'number' ? +v.toFixed(4) : v}`);
    try { history.replaceState(null, '', keep.length ? '#' + keep.join('&') : location.pathname + location.search); } catch { /* not allowed from some places */ }
  }
  function status() {
    if (!pointer) { $('status').textContent = ''; return; }
    const x = Math.floor(state.x + pointer[0] / fit()), y = Math.floor(state.y + pointer[1] / fit());
    if (x < 0 || y < 0 || x >= width || y >= height) { $('status').textContent = ''; return; }
    const value = i => [0, 1, 2].map(c => pictures[i].pixels[3 * (y * width + x) + c].toPrecision(4)).join(' ');
    $('status').textContent = `pixel ${x * data.shrink},${y * data.shrink}   left ${value(state.left)}   right ${value(state.right)}   reference ${value(0)}`;
  }
  function resize() {
    canvas.width = Math.max(64, Math.round(canvas.clientWidth * (devicePixelRatio || 1)));
    canvas.height = Math.round(canvas.width * height / width);
    const most = Math.round(0.8 * Math.max(innerHeight, 400) * (devicePixelRatio || 1));
    if (canvas.height > most) { canvas.height = most; canvas.width = Math.round(most * width / height); }
    canvas.style.width = `${canvas.width / (devicePixelRatio || 1)}px`;
    canvas.style.height = `${canvas.height / (devicePixelRatio || 1)}px`;
    draw();
  }
  function zoom(factor, [px, py] = [canvas.width / 2, canvas.height / 2]) {
    const before = fit(), x = state.x + px / before, y = state.y + py / before;
    state.zoom = clamp(state.zoom * factor, 1, 64);
    state.x = x - px / fit(); state.y = y - py / fit();
    draw();
  }

  const place = e => { const r = canvas.getBoundingClientRect(), k = canvas.width / r.width; return [(e.clientX - r.left) * k, (e.clientY - r.top) * k]; };
  let drag = null;
  canvas.addEventListener('pointerdown', e => {
    const p = place(e);
    drag = Math.abs(p[0] - state.at * canvas.width) < 16 || state.zoom === 1 ? 'slider' : p;
    try { canvas.setPointerCapture(e.pointerId); } catch { /* a made-up pointer */ }
    canvas.focus({ preventScroll: true });
    if (drag === 'slider') { state.at = p[0] / canvas.width; draw(); }
  });
  canvas.addEventListener('pointermove', e => {
    const p = pointer = place(e);
    if (drag === 'slider') { state.at = p[0] / canvas.width; draw(); }
    else if (drag) { state.x -= (p[0] - drag[0]) / fit(); state.y -= (p[1] - drag[1]) / fit(); drag = p; draw(); }
    else status();
  });
  const release = () => { drag = null; };
  canvas.addEventListener('pointerup', release); canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('pointerleave', () => { pointer = null; status(); });
  canvas.addEventListener('wheel', e => { e.preventDefault(); zoom(2 ** (-e.deltaY / 240), place(e)); }, { passive: false });

  const keys = {
    ArrowLeft: () => state.at -= 0.02, ArrowRight: () => state.at += 0.02,
    '+': () => state.ev += 0.5, '=': () => state.ev += 0.5, '-': () => state.ev -= 0.5,
    d: () => state.mode = state.mode === 'difference' ? 'split' : 'difference',
    s: () => [state.left, state.right] = [state.right, state.left],
    z: () => zoom(2, pointer || undefined), x: () => zoom(0.5, pointer || undefined),
    0: () => Object.assign(state, start),
  };
  addEventListener('keydown', e => {
    if (!alone && document.activeElement !== canvas) return;
    if (e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|TH)$/.test(e.target.tagName || '')) return;
    const digit = /^Digit([1-9])$/.exec(e.code || '');
    if (digit && +digit[1] <= pictures.length) state[e.shiftKey ? 'right' : 'left'] = digit[1] - 1;
    else if (Object.hasOwn(keys, e.key)) keys[e.key]();
    else return;
    e.preventDefault();
    draw();
  });
  for (const [id, name] of [['left', 'left'], ['right', 'right'], ['exposure', 'ev'], ['scale', 'scale']]) {
    $(id).addEventListener('input', e => { state[name] = +e.target.value; draw(); });
  }
  $('mode').addEventListener('input', e => { state.mode = e.target.value; draw(); });
  $('reset').addEventListener('click', () => { Object.assign(state, start); draw(); });
  addEventListener('resize', resize);

  resize();
  return pictures.length;
}

// Sorting by the number behind each cell; by text in the first column.
function sortable(table) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((th, column) => {
    const sort = () => {
      const up = th.getAttribute('aria-sort') !== 'ascending';
      heads.forEach(h => h.removeAttribute('aria-sort'));
      th.setAttribute('aria-sort', up ? 'ascending' : 'descending');
      const value = row => { const v = row.cells[column].dataset.value; return v === undefined ? row.cells[column].textContent : v === '' ? Infinity : +v; };
      const rows = [...table.tBodies[0].rows].sort((a, b) => { const [x, y] = [value(a), value(b)]; return (x > y) - (x < y); });
      table.tBodies[0].append(...(up ? rows : rows.reverse()));
    };
    th.addEventListener('click', sort);
    th.addEventListener('keydown', e => { if (e.key === 'Enter') sort(); });
  });
}

const scripts = [...document.querySelectorAll('script.pictures')];
document.documentElement.dataset.ready = scripts.reduce((sum, s) => sum + viewer(s, scripts.length === 1), 0);
document.querySelectorAll('table#table').forEach(sortable);
