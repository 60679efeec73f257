"""One example of each command, shown by its help and where an argument is missing."""

VIRTUAL = "TCPIP0::127.0.0.1::3500::SOCKET"
EXAMPLES = {
    "describe": "rcskin describe sheet-5x5 -o sheet.png",
    "new": "rcskin new my.toml --from glove",
    "sweep": "rcskin sweep sheet-5x5 -o all.nc",
    "plot": "rcskin plot all.nc -o all.png",
    "page": "rcskin page sheet-5x5 -o skin.html",
    "view": "rcskin view sheet-5x5 --press 2,3 --frequency 1e4 -o field.png",
    "import": "rcskin import eis.csv --press none -o eis.nc",
    "join": "rcskin join monday.nc tuesday.nc -o all.nc",
    "check": "rcskin check all.nc -o report.png",
    "dataset": "rcskin dataset sheet-5x5 --sweeps 2000 -o skins.zarr",
    "export": "rcskin export skins.zarr -o skins.csv",
    "study": "rcskin study sheet-5x5 -o study.csv",
    "limits": "rcskin limits sheet-5x5 -o limits",
    "frequencies": "rcskin frequencies sheet-5x5 -n 8",
    "design": "rcskin design sheet-5x5-two-interfaces --want 0.9 -o designed",
    "calibrate": "rcskin calibrate sheet-5x5 run.nc -o found",
    "gap": "rcskin gap all.nc run.nc -o gap",
    "train": "rcskin train skins.zarr -o columns.skops",
    "adapt": "rcskin adapt columns.skops run.nc -o better.skops",
    "evaluate": "rcskin evaluate columns.skops all.nc -o found",
    "localize": "rcskin localize columns.skops all.nc",
    "live": f"rcskin live --model columns.skops --resource {VIRTUAL}",
}
OF_THE_METER = {
    "serve": "rcskin meter serve --scene sheet-5x5",
    "record": f"rcskin meter record sheet-5x5 --resource {VIRTUAL} -o run.nc",
    "gather": "rcskin meter gather run.nc -o so-far.nc",
    "correct": f"rcskin meter correct open --resource {VIRTUAL}",
    "press": "rcskin meter press 2,3",
    "misbehave": "rcskin meter misbehave late --times 2",
}
