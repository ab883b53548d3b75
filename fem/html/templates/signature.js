/* Author, checker and revision: what is typed into the page is printed, and can be kept in a copy of the file. */
"use strict";
(() => {
  const save = document.getElementById("save");
  save.addEventListener("click", () => {
    for (const input of document.querySelectorAll("#signature input")) input.setAttribute("value", input.value);
    const page = document.documentElement.cloneNode(true);
    for (const mark of page.querySelectorAll(".cursor, .spot")) mark.remove();
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(["<!DOCTYPE html>\n" + page.outerHTML], { type: "text/html" }));
    link.download = save.dataset.name;
    link.click();
    URL.revokeObjectURL(link.href);
  });
})();
