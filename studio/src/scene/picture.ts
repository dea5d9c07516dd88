// A picture that one takes away: the scene with its scale bar, the legend of what is shown and the speeds with their error.

/** What stands on a picture beside the scene. */
export interface Caption {
  /** a line for each design: colour of its path, what it is, how fast and how sure */
  designs: { colour: string; text: string; trust: string }[];
  /** colour and name of each kind of arrow */
  arrows: { colour: string; text: string }[];
  bar: { pixels: number; text: string };
  /** least and largest speed of the flow on its slice, with a colour for each share between */
  flow: { colours: string[]; low: string; high: string } | null;
}

/** pixels of the screen below which two scales have no room side by side */
const NARROW = 700;

const FONT = "'Inter Variable', 'DejaVu Sans', sans-serif";

/** The scene's canvas with its caption below, as a PNG; `scale` pixels of it are one on the screen. */
export async function captioned(scene: CanvasImageSource & { width: number; height: number }, scale: number, caption: Caption): Promise<Blob> {
  const canvas = document.createElement("canvas");
  canvas.width = scene.width;
  canvas.height = scene.height;
  const g = canvas.getContext("2d")!;
  g.drawImage(scene, 0, 0);
  g.scale(scale, scale);
  const [w, h] = [scene.width / scale, scene.height / scale];
  g.textBaseline = "middle";
  let y = 28;
  for (const { colour, text, trust } of caption.designs) {
    write(g, text, 40, y, "#f2f6fa", `600 15px ${FONT}`);
    dot(g, 26, y, colour);
    write(g, trust, 40, y + 20, "#b8c4d2", `12px ${FONT}`);
    y += 50;
  }
  let x = 24;
  for (const { colour, text } of caption.arrows) {
    g.fillStyle = colour;
    g.fillRect(x, h - 28.5, 14, 3);
    x += 20 + write(g, text, x + 20, h - 27, "#d5dee8", `12px ${FONT}`) + 18;
  }
  rule(g, w / 2, h - 34, caption.bar);
  if (caption.flow) scaleOf(g, w - 236, w < NARROW ? h - 84 : h - 34, caption.flow);
  const made = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
  if (!made) throw new Error("The browser made no picture.");
  return made;
}

function write(g: CanvasRenderingContext2D, text: string, x: number, y: number, colour: string, font: string): number {
  g.font = font;
  g.fillStyle = colour;
  g.fillText(text, x, y);
  return g.measureText(text).width;
}

function dot(g: CanvasRenderingContext2D, x: number, y: number, colour: string): void {
  g.fillStyle = colour;
  g.beginPath();
  g.arc(x, y, 5, 0, 7);
  g.fill();
}

function rule(g: CanvasRenderingContext2D, middle: number, y: number, bar: Caption["bar"]): void {
  g.strokeStyle = "#f2f6fa";
  g.lineWidth = 1.5;
  g.beginPath();
  g.moveTo(middle - bar.pixels / 2, y - 6);
  g.lineTo(middle - bar.pixels / 2, y);
  g.lineTo(middle + bar.pixels / 2, y);
  g.lineTo(middle + bar.pixels / 2, y - 6);
  g.stroke();
  g.textAlign = "center";
  write(g, bar.text, middle, y + 13, "#f2f6fa", `12px ${FONT}`);
  g.textAlign = "left";
}

function scaleOf(g: CanvasRenderingContext2D, x: number, y: number, flow: NonNullable<Caption["flow"]>): void {
  const wide = 212 / flow.colours.length;
  flow.colours.forEach((colour, i) => {
    g.fillStyle = colour;
    g.fillRect(x + i * wide, y - 4, wide + 0.5, 8);
  });
  write(g, flow.low, x, y + 16, "#d5dee8", `12px ${FONT}`);
  g.textAlign = "right";
  write(g, flow.high, x + 212, y + 16, "#d5dee8", `12px ${FONT}`);
  g.textAlign = "left";
}
