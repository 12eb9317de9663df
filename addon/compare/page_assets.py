# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Style and script of the report page. Inline, because the page is one file that works without a network."""

STYLE = """
:root { color-scheme: light dark;
  --page: #f5f6f8; --card: #fff; --ink: #1b1f27; --soft: #5d6675; --line: #dfe3ea; --good: #15803d; --fair: #a16207;
  --bad: #c2263a; --accent: #2463c9; --well: #e9ecf1; }
@media (prefers-color-scheme: dark) { :root {
  --page: #14171c; --card: #1c2027; --ink: #e7eaf0; --soft: #9aa4b4; --line: #2d333d; --good: #4ade80; --fair: #facc15;
  --bad: #ff7583; --accent: #82b1ff; --well: #0e1014; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 15px/1.5 system-ui, "Segoe UI", Roboto, sans-serif; }
main, header { max-width: 1680px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 28px; }
h1 { font-size: 26px; margin: 0 0 4px; letter-spacing: -.01em; }
h2 { font-size: 19px; margin: 0; }
h3 { font-size: 15px; margin: 0 0 8px; }
p { margin: 6px 0; max-width: 90ch; }
.facts { display: flex; flex-wrap: wrap; gap: 2px 22px; color: var(--soft); font-size: 13px; margin: 6px 0 18px; }
.facts b { color: var(--ink); font-weight: 600; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 10px; padding: 16px 18px;
  margin: 0 0 20px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13.5px; }
.summary { width: 100%; }
th, td { text-align: right; padding: 4px 12px; border-bottom: 1px solid var(--line); white-space: nowrap; }
th { color: var(--soft); font-weight: 600; }
th small { display: block; font-weight: 400; }
th:first-child, td:first-child, .text { text-align: left; }
tbody tr:last-child td { border-bottom: 0; }
tr.best td { font-weight: 600; }
a { color: var(--accent); text-decoration: none; } a:hover { text-decoration: underline; }
.good { color: var(--good); } .fair { color: var(--fair); } .bad { color: var(--bad); }
.bar { display: inline-block; height: 8px; border-radius: 2px; background: var(--accent); vertical-align: middle;
  margin-left: 8px; min-width: 1px; }
.rail { display: inline-block; width: 90px; text-align: left; }
.head { display: flex; flex-wrap: wrap; align-items: baseline; gap: 2px 14px; margin-bottom: 12px; }
.head span { color: var(--soft); font-size: 13px; }
.row { margin-top: 16px; border-top: 1px solid var(--line); padding-top: 12px; }
.row h3 { font-size: 16px; }
.three { display: grid; gap: 12px; grid-template-columns: repeat(3, minmax(0, 1fr)); }
@media (max-width: 900px) { .three { grid-template-columns: 1fr; } .again { display: none; } }
figure { margin: 0; min-width: 0; }
figcaption { font-size: 13px; color: var(--soft); margin-bottom: 5px; }
figcaption b { color: var(--ink); }
.view { position: relative; overflow: hidden; background: var(--well); border-radius: 6px; cursor: zoom-in;
  touch-action: pan-y; outline: 1px solid var(--line); outline-offset: -1px; }
.view.zoomed { cursor: grab; touch-action: none; } .view.dragging { cursor: grabbing; }
.view img { display: block; width: 100%; transform-origin: 0 0; user-select: none; -webkit-user-drag: none; }
.view.zoomed img { image-rendering: pixelated; }
.legend { display: flex; flex-wrap: wrap; gap: 3px 16px; font-size: 12.5px; color: var(--soft); margin: 8px 0 0;
  padding: 0; }
.legend li { list-style: none; }
.legend i { display: inline-block; width: 11px; height: 11px; border-radius: 2px; margin-right: 6px;
  vertical-align: -1px; }
.numbers { display: flex; flex-wrap: wrap; gap: 16px 34px; margin-top: 10px; align-items: flex-start; }
.numbers td, .numbers th { padding: 2px 10px 2px 0; }
details { font-size: 13px; color: var(--soft); margin-top: 8px; } summary { cursor: pointer; }
.note { color: var(--soft); font-size: 13px; }
kbd { font: inherit; font-size: 12px; border: 1px solid var(--line); border-radius: 4px; padding: 0 5px; }
footer { max-width: 1680px; margin: 0 auto; padding: 0 24px 30px; color: var(--soft); font-size: 13px; }
"""

# All pictures of a light share one zoom and place, so that the same spot is compared in each.
SCRIPT = """
for (const group of document.querySelectorAll('[data-zoom]')) {
  const views = [...group.querySelectorAll('.view')];
  for (const image of group.querySelectorAll('.again img')) image.src = views[0].firstElementChild.src;
  const state = { zoom: 1, x: 0, y: 0 };          // x, y: left upper corner in widths and heights of the picture
  const show = () => {
    const room = 1 - 1 / state.zoom;
    state.x = Math.min(Math.max(state.x, 0), room);
    state.y = Math.min(Math.max(state.y, 0), room);
    for (const view of views) {
      view.classList.toggle('zoomed', state.zoom > 1);
      const image = view.firstElementChild;
      image.style.transform = state.zoom === 1 ? '' :
        `scale(${state.zoom}) translate(${-state.x * 100}%, ${-state.y * 100}%)`;
    }
  };
  const place = (event, view) => {
    const box = view.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  };
  const zoom_at = (u, v, zoom) => {
    zoom = Math.min(Math.max(zoom, 1), 64);
    state.x += u / state.zoom - u / zoom;
    state.y += v / state.zoom - v / zoom;
    state.zoom = zoom;
    show();
  };
  for (const view of views) {
    let start = null;
    view.addEventListener('wheel', event => {
      if (state.zoom === 1 && !event.ctrlKey) return;   // the page scrolls until a picture is zoomed
      event.preventDefault();
      zoom_at(...place(event, view), state.zoom * Math.exp(-event.deltaY * 0.002));
    }, { passive: false });
    view.addEventListener('pointerdown', event => {
      start = { at: [event.clientX, event.clientY], x: state.x, y: state.y, moved: false };
      view.setPointerCapture(event.pointerId);
    });
    view.addEventListener('pointermove', event => {
      if (!start) return;
      const box = view.getBoundingClientRect();
      const dx = event.clientX - start.at[0], dy = event.clientY - start.at[1];
      if (Math.hypot(dx, dy) > 4) start.moved = true;
      if (!start.moved || state.zoom === 1) return;
      view.classList.add('dragging');
      state.x = start.x - dx / box.width / state.zoom;
      state.y = start.y - dy / box.height / state.zoom;
      show();
    });
    const end = event => {
      view.classList.remove('dragging');
      if (start && !start.moved && event.type === 'pointerup')
        zoom_at(...place(event, view), state.zoom === 1 ? 4 : state.zoom < 16 ? state.zoom * 2 : 1);
      start = null;
    };
    view.addEventListener('pointerup', end);
    view.addEventListener('pointercancel', end);
  }
  addEventListener('keydown', event => {
    if (event.key === 'Escape' || event.key === '0') { state.zoom = 1; show(); }
  });
}
"""
