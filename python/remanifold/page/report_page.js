// SPDX-License-Identifier: GPL-3.0-or-later
(() => {
  "use strict";
  const button = document.getElementById("download");
  if (button) {
    button.addEventListener("click", () => {
      const packed = atob(document.getElementById("mesh").textContent);
      const bytes = Uint8Array.from(packed, (letter) => letter.charCodeAt(0));
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([bytes]));
      link.download = button.dataset.name;
      link.click();
      button.dataset.bytes = bytes.length;
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    });
  }
})();
(() => {
  "use strict";
  const place = document.getElementById("picture");
  const read = (name) => JSON.parse(document.getElementById(name).textContent);
  const { views, layout } = read("figure");
  const canvas = document.createElement("canvas");
  if (!window.Plotly || !(canvas.getContext("webgl2") || canvas.getContext("webgl"))) {
    place.textContent = "This browser cannot draw in three dimensions (no WebGL).";
    return;
  }
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const inColorsOfThePage = () => {
    const style = getComputedStyle(document.documentElement);
    layout.font = { ...layout.font, color: style.getPropertyValue("--ink").trim() };
    layout.paper_bgcolor = "rgba(0,0,0,0)";
    layout.scene.bgcolor = "rgba(0,0,0,0)";
    const color = style.getPropertyValue("--faint").trim();
    layout.modebar = { bgcolor: "rgba(0,0,0,0)", color, activecolor: layout.font.color };
  };
  const buttons = [["toImage", "zoom3d", "pan3d", "orbitRotation", "resetCameraDefault3d"]];
  const config = { responsive: true, displaylogo: false, modeBarButtons: buttons };
  let chosen = 0;
  let seen = 0;
  const draw = () => {
    place.dataset.drawn = "no";
    inColorsOfThePage();
    const { data, looks, caption } = views[seen];
    const look = looks[chosen];
    document.getElementById("caption").textContent = caption;
    const shown = data.map((trace, i) => ({ ...trace, ...(look.traces[i] || {}) }));
    // Anew: an update would keep the colors that the plain picture lacks. The layout
    // is the one at hand, and with it the camera.
    Plotly.newPlot(place, shown, layout, config).then(() => { place.dataset.drawn = "yes"; });
  };
  // What fits the height may be too wide for a phone.
  const eye = layout.scene.camera.eye;
  const flat = eye.x === 0 && eye.y === 0;
  const back = Math.max(1, ((flat ? 1.6 : 1.1) * place.clientHeight) / place.clientWidth);
  for (const axis of ["x", "y", "z"]) eye[axis] *= back;
  const chooser = document.getElementById("color");
  if (chooser) {
    chooser.addEventListener("change", () => { chosen = chooser.selectedIndex; draw(); });
  }
  const turner = document.getElementById("view");
  if (turner) {
    turner.addEventListener("change", () => { seen = turner.selectedIndex; draw(); });
  }
  dark.addEventListener("change", draw);
  draw();
})();
