// What the theme leaves out for those who use a keyboard or a screen reader.
addEventListener("DOMContentLoaded", () => {
  document.querySelector(".sidebar-drawer")?.setAttribute("aria-label", "All pages");
  document.querySelector(".toc-drawer")?.setAttribute("aria-label", "This page");
  document.querySelectorAll(".ck-guess-still").forEach((one, at) => one.setAttribute("aria-label", `Question ${at + 1}`));
  for (const corner of document.querySelectorAll("th.head"))
    if (!corner.textContent.trim()) corner.outerHTML = "<td></td>"; // it heads nothing
  const makeReachable = () => {
    for (const block of document.querySelectorAll("article pre, article .table-wrapper, article .output.text_html"))
      if (block.scrollWidth > block.clientWidth) block.tabIndex = 0; // the arrow keys scroll it then
  };
  makeReachable();
  addEventListener("resize", makeReachable);
  addEventListener("toggle", makeReachable, true); // an answer is unfolded
});
