"use strict";
// Plays the surfaces over the cycle. `drawing`: what it has in common with the page's other views.
// Nothing moves before it is asked to, whatever the reader's wish for less motion is.
const cyclePlayer = (figure, figures, drawing) => {
  const { CONFIG, inked, ink, dark, still, opacityOf, fromAfar } = drawing;
  const byId = (name) => document.getElementById(`player-${name}`);
  const [button, slider, now, speed, glass, canvas] = ["play", "frame", "now", "speed", "glass", "scene"].map(byId);
  const boxes = [...document.querySelectorAll("#player [data-surface]")];
  const picture = still(canvas, "png");
  const ARRAYS = { f4: Float32Array, u2: Uint16Array, u4: Uint32Array };

  const unpacked = (packed) => new ARRAYS[packed.dtype](Uint8Array.from(atob(packed.bdata), (c) => c.charCodeAt(0)).buffer);

  // plotly looks up what is under the mouse by the number of the triangle that it drew last, which
  // must still be there in the next frame: those that lack some have the first corner, over and over.
  const padded = (corners, count) => {
    const all = new corners.constructor(count);
    all.set(corners);
    return all;
  };

  // Where a surface is in each of its frames: coordinates, and corners where those change too.
  const placesOf = (surface) => {
    if (surface.own) {
      const places = surface.own.map(({ scene, trace }) => {
        const drawn = figures.scenes[scene].data[trace];
        return Object.fromEntries(["x", "y", "z", "i", "j", "k"].map((name) => [name, unpacked(drawn[name])]));
      });
      const most = Math.max(...places.map(({ i }) => i.length));
      for (const place of places) for (const name of ["i", "j", "k"]) place[name] = padded(place[name], most);
      return places;
    }
    const { origin, step } = surface.positions;
    const all = Float32Array.from(unpacked(surface.positions), (steps) => origin + step * steps);
    const count = all.length / surface.shown.length / 3;
    const plane = (n) => all.subarray(n * count, (n + 1) * count);
    return surface.shown.map((_, n) => ({ x: plane(3 * n), y: plane(3 * n + 1), z: plane(3 * n + 2) }));
  };
  const surfaces = figure.surfaces.map((one) => ({ ...one, places: placesOf(one) }));
  // In a frame that lacks it a surface is hidden, wherever it is.
  const placeAt = ({ shown, places }, frame) => places[Math.max(0, shown.findLastIndex((at) => at <= frame))];

  let frame = 0;
  const mark = () => {
    const chart = document.getElementById("cycle-chart0");
    const shapes = figures.charts["cycle-chart0"]?.layout.shapes;
    if (!shapes) return;
    shapes[0].x0 = shapes[0].x1 = figure.frames[frame].at;
    if (chart.layout) Plotly.relayout(chart, { "shapes[0].x0": shapes[0].x0, "shapes[0].x1": shapes[0].x1 });
  };

  // From where the reader looks. plotly's layout has it only once the mouse is let go: until then
  // the next frame would turn the heart back.
  const camera = () => canvas._fullLayout?.scene?._scene?.getCamera();

  const draw = async () => {
    const layout = inked(figure.layout, ink());
    layout.scene.camera = camera() ?? fromAfar(layout.scene.camera, canvas);
    const data = surfaces.map((one, index) => {
      const trace = { ...one.trace, ...placeAt(one, frame) };
      return { ...trace, opacity: opacityOf(trace, Number(glass.value)), visible: boxes[index].checked && one.shown.includes(frame) };
    });
    await Plotly.react(canvas, data, layout, CONFIG);
  };

  const show = async (next) => {
    frame = next;
    const lacking = surfaces.filter(({ shown }) => !shown.includes(frame)).map(({ structure }) => structure);
    const said = [figure.frames[frame].said, ...lacking.map((structure) => `no ${structure}`)].join(", ");
    slider.value = frame;
    slider.setAttribute("aria-valuetext", said);
    now.textContent = said;
    mark();
    await draw();
  };

  // Of the moment in seconds since the first frame: the last frame that was before.
  const frameAt = (moment) => Math.max(0, figure.seconds.findLastIndex((second) => second <= moment));

  let playing = false;
  let [from, since] = [0, 0];
  const begin = () => [from, since] = [figure.seconds[frame], performance.now()];
  const tick = async () => {
    if (!playing) return;
    const moment = (from + ((performance.now() - since) / 1000) * Number(speed.value)) % figure.period_s;
    const next = frameAt(moment);
    // A screen that is too slow leaves frames out rather than time.
    if (next !== frame) await show(next);
    requestAnimationFrame(tick);
  };
  const play = () => {
    playing = true;
    button.textContent = "Pause";
    begin();
    requestAnimationFrame(tick);
  };
  const pause = () => {
    if (!playing) return;
    playing = false;
    button.textContent = "Play";
    picture.soon();
  };

  const redraw = async () => {
    if (!canvas.data) return;
    await draw();
    picture.soon();
  };
  button.addEventListener("click", () => (playing ? pause() : play()));
  slider.addEventListener("input", async () => {
    pause();
    await show(Number(slider.value));
    picture.soon();
  });
  // What has been played so far stays as it was.
  speed.addEventListener("input", begin);
  for (const control of [glass, ...boxes]) control.addEventListener("input", redraw);
  dark.addEventListener("change", redraw);

  const begun = async () => {
    await show(0);
    canvas.on("plotly_relayout", picture.soon);
  };
  return { begun, picture };
};
