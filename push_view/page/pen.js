'use strict';
// What everything on the floor is drawn with, in metres.

class Pen {
  constructor(context, camera) {
    this.context = context;
    this.camera = camera;
    this.setTheme();
  }

  setTheme() { this.colors = themeColors(); }

  // Longer steps than ``jump`` [m] are left out.
  line(points, color, width, dash = [], jump = Infinity) {
    if (points.length < 2) return;
    const c = this.context;
    c.beginPath();
    points.forEach((point, i) => {
      const [x, y] = this.camera.toScreen(point);
      const isDrawn = i && Math.hypot(point[0] - points[i - 1][0], point[1] - points[i - 1][1]) < jump;
      if (isDrawn) c.lineTo(x, y); else c.moveTo(x, y);
    });
    c.setLineDash(dash);
    c.lineWidth = width;
    c.strokeStyle = color;
    c.stroke();
    c.setLineDash([]);
  }

  shape(points, { fill, stroke, width = 1.5, dash = [], alpha = 1 }) {
    const c = this.context;
    c.beginPath();
    points.forEach((point) => c.lineTo(...this.camera.toScreen(point)));
    c.closePath();
    if (fill) {
      c.globalAlpha = alpha;
      c.fillStyle = fill;
      c.fill();
      c.globalAlpha = 1;
    }
    if (!stroke) return;
    c.setLineDash(dash);
    c.lineWidth = width;
    c.strokeStyle = stroke;
    c.stroke();
    c.setLineDash([]);
  }

  circle(point, radius, { fill, stroke, width = 1.5, dash = [], alpha = 1 }) {
    const c = this.context;
    c.beginPath();
    c.arc(...this.camera.toScreen(point), radius, 0, 2 * Math.PI);
    if (fill) {
      c.globalAlpha = alpha;
      c.fillStyle = fill;
      c.fill();
      c.globalAlpha = 1;
    }
    if (stroke) {
      c.setLineDash(dash);
      c.lineWidth = width;
      c.strokeStyle = stroke;
      c.stroke();
      c.setLineDash([]);
    }
  }

  label(text, point, color) {
    const c = this.context, [x, y] = this.camera.toScreen(point);
    this.circle(point, 9, { fill: this.colors.paper, stroke: color, width: 2 });
    c.fillStyle = this.colors.ink;
    c.font = 'bold 11px system-ui, sans-serif';
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    c.fillText(text, x, y + 0.5);
  }
}
