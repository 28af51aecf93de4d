// What the theme leaves out for those who use a keyboard or a screen reader.
addEventListener("DOMContentLoaded", () => {
  document.querySelector(".sidebar-drawer")?.setAttribute("aria-label", "All pages");
  document.querySelector(".toc-drawer")?.setAttribute("aria-label", "This page");
  document.querySelectorAll(".ck-guess-still").forEach((one, at) => one.setAttribute("aria-label", `Question ${at + 1}`));
  for (const corner of document.querySelectorAll("th.head"))
    if (!corner.textContent.trim()) corner.outerHTML = "<td></td>"; // it heads nothing
  // At OWNER.github.io/REPOSITORY the front page leads to where the course runs without a set-up.
  const [, owner] = /^([^.]+)\.github\.io$/.exec(location.hostname) ?? [];
  const repository = `${owner}/${location.pathname.split("/")[1]}`;
  const first = "lab/tree/my-course/notebooks/00_welcome.ipynb";
  if (owner)
    document.querySelector("section#start > h2")?.insertAdjacentHTML(
      "afterend",
      `<p>Try it in your browser first: <a href="https://mybinder.org/v2/gh/${repository}/HEAD?urlpath=${first}">Binder</a>
      (no account; it may take some minutes to start),
      <a href="https://codespaces.new/${repository}">Codespaces</a> (with a GitHub account).</p>`,
    );
  const makeReachable = () => {
    for (const block of document.querySelectorAll("article pre, article .table-wrapper, article .output.text_html"))
      if (block.scrollWidth > block.clientWidth) block.tabIndex = 0; // the arrow keys scroll it then
  };
  makeReachable();
  addEventListener("resize", makeReachable);
  addEventListener("toggle", makeReachable, true); // an answer is unfolded
});
