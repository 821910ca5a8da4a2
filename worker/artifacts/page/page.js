"use strict";
// Draws the page's 3D views and charts, out of the JSON beside it, with the plotly.js in the page.
(() => {
  const figures = JSON.parse(document.getElementById("figures").textContent);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  // Nothing of the page is for a cloud: plotly would offer to send it there.
  const CONFIG = { responsive: true, displaylogo: false, showSendToCloud: false, displayModeBar: false };
  const SCENE_BUTTONS = [["toImage"], ["zoom3d", "pan3d", "orbitRotation"], ["resetCameraDefault3d"]];
  const SCENE_CONFIG = { ...CONFIG, displayModeBar: true, modeBarButtons: SCENE_BUTTONS };
  // Browsers give up the oldest of 8 to 16 WebGL contexts; beyond this many, views rest as pictures.
  const MOST_SCENES = figures.cycle ? 5 : 6;
  const CLEAR = "rgba(0,0,0,0)";
  const STILL_AFTER_MS = 1200;

  const inked = (layout, ink) => {
    const lines = { gridcolor: "rgba(128,128,128,0.28)", linecolor: "rgba(128,128,128,0.6)", zerolinecolor: "rgba(128,128,128,0.5)" };
    const toned = { ...layout, font: { family: "system-ui, sans-serif", size: 12, color: ink }, paper_bgcolor: CLEAR, plot_bgcolor: CLEAR, modebar: { bgcolor: CLEAR, color: "#888888", activecolor: ink } };
    for (const name of ["xaxis", "yaxis"]) if (layout[name]) toned[name] = { ...lines, ...layout[name] };
    if (layout.scene) {
      toned.scene = { ...layout.scene };
      for (const name of ["xaxis", "yaxis", "zaxis"]) toned.scene[name] = { ...lines, color: ink, ...layout.scene[name] };
    }
    return toned;
  };
  const ink = () => (dark.matches ? "#dddddd" : "#333333");

  // Paper has no WebGL: every figure keeps a picture of itself, which is what is printed.
  const still = (canvas, format) => {
    const picture = canvas.parentElement.querySelector(".still");
    let waiting = 0;
    const take = async () => {
      const layout = inked(canvas.layout, "#333333");
      const { width, height } = canvas.getBoundingClientRect();
      if (!width) return;
      picture.src = await Plotly.toImage({ data: canvas.data, layout }, { format, width, height, scale: format === "png" ? 2 : 1 });
    };
    const soon = () => {
      clearTimeout(waiting);
      waiting = setTimeout(take, STILL_AFTER_MS);
    };
    return { take, soon };
  };

  const drawChart = async (id, figure) => {
    const canvas = document.getElementById(id);
    const draw = () => Plotly.react(canvas, figure.data, inked(figure.layout, ink()), CONFIG);
    await draw();
    dark.addEventListener("change", draw);
    await still(canvas, "svg").take();
  };

  const decoded = (packed) => {
    const bytes = Uint8Array.from(atob(packed.bdata), (c) => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  };

  const coloured = (trace, index, colouring) => {
    const values = colouring?.values[index];
    // Beside colours that mean something, what has no such number is grey glass.
    if (!values) return colouring && isSurface(trace) ? { ...trace, color: "#9a9a9a", opacity: 0.15 } : trace;
    const text = colouring.mode === "cell" ? "" : Array.from(decoded(values), (x) => `<br>${colouring.label} ${x.toPrecision(3)} ${colouring.unit}`);
    return { ...trace, intensity: values, intensitymode: colouring.mode, coloraxis: "coloraxis", text };
  };

  const isSurface = (trace) => ["surface", "enclosing"].includes(trace.meta.role);

  const opacityOf = (trace, glass) => {
    if (trace.opacity !== undefined) return trace.opacity;
    return trace.meta.role === "surface" ? Math.min(1, glass + 0.7) : trace.meta.role === "enclosing" ? glass : 1;
  };

  // The camera's angle is that of the height: a narrow view needs more distance to hold the width.
  const fromAfar = (camera, canvas) => {
    const far = Math.max(1, (1.2 * canvas.clientHeight) / canvas.clientWidth);
    const eye = Object.fromEntries(Object.entries(camera.eye).map(([axis, at]) => [axis, at * far]));
    return { ...camera, eye };
  };

  const sceneOf = (id, figure) => {
    const canvas = document.getElementById(id);
    const frame = canvas.parentElement;
    const [select, slider] = [frame.querySelector("select"), frame.querySelector("input[type=range]")];
    const layers = [...frame.querySelectorAll("[data-trace]")];
    const picture = still(canvas, "png");
    let drawn = false;

    const draw = async () => {
      const colouring = figure.colourings[select.value];
      frame.querySelector(".hint").textContent = colouring ? colouring.hint : "";
      const shown = new Set(layers.filter((box) => box.checked).map((box) => Number(box.dataset.trace)));
      const data = figure.data.map((plain, index) => {
        const trace = coloured(plain, index, colouring);
        return { ...trace, opacity: opacityOf(trace, Number(slider.value)), visible: shown.has(index) };
      });
      const layout = inked(figure.layout, ink());
      layout.scene.camera = fromAfar(layout.scene.camera, canvas);
      if (colouring) {
        const bar = { orientation: "h", x: 0.5, y: 1, yanchor: "bottom", thickness: 10, len: 0.9, title: { text: colouring.title, side: "top" }, tickfont: { size: 10 } };
        layout.coloraxis = { ...colouring.coloraxis, colorbar: { ...bar, ...colouring.coloraxis.colorbar } };
      }
      await Plotly.react(canvas, data, layout, SCENE_CONFIG);
      if (!drawn) canvas.on("plotly_relayout", picture.soon);
      drawn = true;
    };
    const redraw = async () => {
      if (!drawn) return;
      await draw();
      picture.soon();
    };
    for (const control of [select, slider, ...layers]) control.addEventListener("input", redraw);
    dark.addEventListener("change", redraw);
    const rest = () => {
      frame.classList.add("resting");
      Plotly.purge(canvas);
      drawn = false;
    };
    const wake = async () => {
      frame.classList.remove("resting");
      await draw();
    };
    return { frame, picture, rest, wake };
  };

  const hasWebgl = () => {
    const context = document.createElement("canvas").getContext("webgl");
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return context !== null;
  };

  const able = hasWebgl();
  const awake = [];
  const drawScene = async (id) => {
    const scene = sceneOf(id, figures.scenes[id]);
    scene.frame.querySelector(".still").addEventListener("click", async () => {
      awake.shift().rest();
      awake.push(scene);
      await scene.wake();
    });
    await scene.wake();
    await scene.picture.take();
    return scene;
  };

  const player = figures.cycle && able ? cyclePlayer(figures.cycle, figures, { CONFIG: SCENE_CONFIG, inked, ink, dark, still, opacityOf, fromAfar }) : null;
  // A folded frame is drawn when it is opened.
  const isFolded = (id) => document.getElementById(id).closest("details.frame:not([open])") !== null;
  const isOf = (one) => (id) => one.contains(document.getElementById(id));

  const drawAll = async () => {
    if (!able) for (const one of document.querySelectorAll("[data-scene], .player")) one.classList.add("unable");
    await player?.begun();
    for (const id of Object.keys(figures.scenes)) {
      if (!able || isFolded(id)) continue;
      const scene = await drawScene(id);
      if (awake.length < MOST_SCENES) awake.push(scene);
      else scene.rest();
    }
    for (const [id, figure] of Object.entries(figures.charts)) if (!isFolded(id)) await drawChart(id, figure);
    await player?.picture.take();
    document.documentElement.dataset.drawn = "yes";
  };

  const drawFrame = async (frame) => {
    for (const id of Object.keys(figures.scenes).filter(isOf(frame))) {
      if (!able) continue;
      if (awake.length >= MOST_SCENES) awake.shift().rest();
      awake.push(await drawScene(id));
    }
    for (const id of Object.keys(figures.charts).filter(isOf(frame))) await drawChart(id, figures.charts[id]);
    frame.dataset.drawn = "yes";
  };
  for (const frame of document.querySelectorAll("details.frame")) {
    const opened = () => {
      if (!frame.open) return;
      frame.removeEventListener("toggle", opened);
      drawFrame(frame);
    };
    frame.addEventListener("toggle", opened);
  }
  const openNamed = () => {
    const named = document.getElementById(location.hash.slice(1));
    if (named?.matches("details.frame")) named.open = true;
  };
  addEventListener("hashchange", openNamed);
  openNamed();

  // On paper nothing can be unfolded; a whole frame stays as it is, for there may be very many.
  let unfolded = [];
  addEventListener("beforeprint", () => {
    unfolded = [...document.querySelectorAll("details:not([open], .frame)")];
    for (const one of unfolded) one.open = true;
  });
  addEventListener("afterprint", () => {
    for (const one of unfolded) one.open = false;
  });

  drawAll();
})();
