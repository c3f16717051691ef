// Steps are numbered from 1. What has data-from is shown from that step on, up to data-to if it has that.
const slider = document.querySelector('input');
const count = Number(slider.max);
const parts = [...document.querySelectorAll('[data-from]')];
const tree = document.querySelector('.tree');

function show(wanted) {
  const step = Math.min(Math.max(Math.round(wanted) || 1, 1), count);
  let call;
  for (const part of parts) {
    const { from, to = count } = part.dataset;
    part.classList.toggle('hidden', step < from || step > to);
    part.classList.toggle('now', step == from);
    if (part.matches('section.now')) call = part.dataset.call;
  }
  let node;
  for (const part of tree.querySelectorAll('[data-call]')) {
    const here = part.dataset.call === call;
    part.classList.toggle('here', here);
    if (here && !node) node = part;
  }
  // Only the tree's own scroll bars move, never the page.
  const [box, at] = [tree.getBoundingClientRect(), node.getBoundingClientRect()];
  if (at.left < box.left || at.right > box.right) tree.scrollLeft += (at.left + at.right - box.left - box.right) / 2;
  if (at.top < box.top || at.bottom > box.bottom) tree.scrollTop += (at.top + at.bottom - box.top - box.bottom) / 2;
  slider.value = step;
  document.querySelector('output').textContent = `step ${step} of ${count}`;
  history.replaceState(null, '', `#${step}`);
}

const go = by => show(Number(slider.value) + by);
const keys = {
  ArrowRight: () => go(1), ArrowLeft: () => go(-1), ArrowDown: () => go(1), ArrowUp: () => go(-1),
  PageDown: () => go(10), PageUp: () => go(-10), Home: () => show(1), End: () => show(count),
};
document.addEventListener('keydown', event => {
  if (event.ctrlKey || event.altKey || event.metaKey || !keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
});
slider.addEventListener('input', () => show(slider.value));
document.querySelector('#back').addEventListener('click', () => go(-1));
document.querySelector('#on').addEventListener('click', () => go(1));
// A click on a node of the tree goes to the beginning of its call.
tree.addEventListener('click', event => {
  const part = event.target.closest('[data-call]');
  if (part) show(tree.querySelector(`[data-call="${part.dataset.call}"]`).dataset.from);
});
addEventListener('hashchange', () => show(location.hash.slice(1)));
show(location.hash.slice(1));
