// The frame of the skin on the front page is as tall as the page in it, which sends its height.
addEventListener("message", ({ source, data }) => {
    const frame = document.querySelector("iframe.skin");
    if (frame && source === frame.contentWindow && Number.isFinite(data?.height))
        frame.style.height = `${data.height}px`;
});
