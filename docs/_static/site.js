// What Sphinx leaves out for screen readers and keyboards: the rank of the captions, the names of the
// navigation and of the page of the search, a way into what is wider than the page.
document.addEventListener("DOMContentLoaded", () => {
  for (const caption of document.querySelectorAll('.caption[role="heading"]'))
    caption.setAttribute("aria-level", "2");
  document.querySelector(".sidebar-drawer")?.setAttribute("aria-label", "Pages");
  document.querySelector(".toc-drawer")?.setAttribute("aria-label", "On this page");
  if (!document.querySelector("h1"))  // the page of the search
    document.querySelector("article")?.insertAdjacentHTML("afterbegin", "<h1>Search</h1>");
  for (const box of document.querySelectorAll("pre, .table-wrapper, article table.docutils"))
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
});
