// The data within the page: what is shown at once, and episodes and pictures decoded on demand.

const KEPT = 12; // decoded episodes held at a time

const decoded = new Map();

/** Runs, tables and a line an episode. */
export function readOverview() {
  return JSON.parse(document.getElementById("overview").textContent);
}

/** Everything about episode `k` of run `r`. */
export function loadEpisode(r, k) {
  const id = `e-${r}-${k}`;
  const episode = decoded.get(id) ?? decodeEpisode(id);
  decoded.delete(id);
  decoded.set(id, episode);
  if (decoded.size > KEPT) decoded.delete(decoded.keys().next().value);
  return episode;
}

/** A picture by its digest, ready to be drawn; null without one, or for a damaged one. */
export async function loadPicture(digest) {
  if (!digest) return null;
  const block = await blockOf(`i-${digest}`);
  const image = new Image();
  image.src = `data:image/webp;base64,${block.textContent}`;
  return image.decode().then(() => image, () => null);
}

async function decodeEpisode(id) {
  const block = await blockOf(id);
  const bytes = Uint8Array.from(atob(block.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).json();
}

/** A block of data, once the page has been read as far as there. */
async function blockOf(id) {
  while (!document.getElementById(id) && document.readyState === "loading") {
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  const block = document.getElementById(id);
  if (!block) throw new Error(`this page holds no ${id}`);
  return block;
}
