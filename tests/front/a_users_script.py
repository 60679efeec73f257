"""What a user may write: all that `import rcskin` gives, with types that a checker follows."""

import numpy as np
import rcskin


def check(value: float) -> float:
    assert value == value
    return value


strip: rcskin.Scene = rcskin.load("strip-1x3")
strip = strip.with_({"dataset.session.sweeps_per_session": 50})
rcskin.write(strip, "strip.toml")

sweeps = rcskin.sweep("strip.toml", ["none", "1,2:1.5", rcskin.Press()], rtol=1e-3, model="line")
recorded = rcskin.measured(sweeps, seed=2)
rcskin.write(recorded, "all.nc")
again = rcskin.read("all.nc")
picture = rcskin.plot(again, "all.png", what=["Rs", "change-Cp"])
assert picture.exists() and again.sizes["sweep"] == 3

skins = rcskin.dataset(strip, 100, seed=1, rtol=1e-3)
X, y = rcskin.features(skins, target="pixel", quantities=["dlnZ", "dphase"])
assert X.shape[0] == y.shape[0]

model: rcskin.Model = rcskin.train(skins, "column", "ksvm-ovo", quantities="dlnZ,dphase")
rcskin.write(model, "columns.npz")
unseen = rcskin.dataset(strip, 50, seed=2, rtol=1e-3)
answers = rcskin.localize(rcskin.load_model("columns.npz"), unseen)
print(answers, answers.labels[0], check(answers.probability[0]), answers.novel.any())
evaluation = rcskin.evaluate("columns.npz", unseen)
print(evaluation, check(evaluation.accuracy), check(evaluation.answered))

limit = rcskin.limits(strip, "pixel", presses=1.5, draws=100)
print(limit, check(limit.accuracy + limit.standard_error))

found = rcskin.calibrate(strip, rcskin.sweep(strip, rtol=1e-3), fit=["capacitance"])
print(found, found.scene.name, check(found.values["capacitance"]), check(found.chi_squared))
for quantity in found.quantities:
    check(quantity.value)

difference = rcskin.gap(skins, unseen, target="pixel", draws=1)
print(difference, difference.summary[0], len(difference.causes), *difference.notes)
difference.write("gap")

study = rcskin.study(strip, {"pixels.columns": [2]}, target="column", repetitions=5)
study.write("study.csv")
study.plot("study.png")
print(study, study.best[0], check(float(study.findings["accuracy"][0])))

reduced = rcskin.reduce(strip, rtol=1e-3)
Z = reduced.solve("1,1", np.array([1e3, 2e3])).Z
print(reduced, Z.shape, rcskin.__version__)

contacts = rcskin.PointContacts([0.02, 0.05], [0.01, 0.02], force=[1.0, 2.0], radius=5e-3)
images = rcskin.DepthImage(np.full((20, 30), 1e-3)), rcskin.PressureImage([[0.0, 1e3]])
print(contacts, *images)

sensor = rcskin.Sensor(strip, seed=1, rtol=1e-2)
reading = sensor.step("1,1", dt=1.0)
print(reading.time, sensor.names[0], check(reading.Rs[0, 0, 0]), sensor.sweeps().sizes["sweep"])

try:
    rcskin.sweep("strip.toml", "9,9")
except rcskin.InputError as error:
    print(error)
except rcskin.ToleranceError as error:
    print(error.times)
