// Browsers start no worker from a file of a folder, so the search would not run there. Its worker starts
// from a copy of its text instead, which `docs/site.py` adds to the index of the search. Zensical would
// load a file with this name, which does less, from elsewhere.
if (location.protocol === "file:") {
    window.Worker = class extends Worker {
        constructor() {
            super(URL.createObjectURL(new Blob([SEARCH_WORKER], { type: "text/javascript" })));
        }
    };
}
