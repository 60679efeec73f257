"""What laws are checked with: dimensionless frequency, a plain solution."""

import numpy as np
import pytest
from rcskin.simulator.fem.assembly import quadrilateral
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.mesh.quadrilaterals import pixel_mesh, tile_lines
from rcskin.simulator.press.capacitance import tile_map
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import csr_matrix, eye_array, kron
from scipy.sparse.linalg import spsolve
from skfem import BilinearForm, LinearForm
from skfem.assembly import Basis, FacetBasis


@pytest.fixture(scope="session")
def frequency_at():
    """A function from u = omega (R_t + R_b) c L², L the longer side, to frequency in Hz."""

    def frequency_at(scene, u):
        skin = scene.skin
        sheets = skin.top.sheet_resistance + skin.bottom.sheet_resistance
        L = max(skin.length, skin.width)
        RC = sheets * skin.foam.unpressed_capacitance_per_area * L**2
        return np.atleast_1d(u) / (2 * np.pi * RC)

    return frequency_at


@BilinearForm
def _laplacian(u, v, _):
    return u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1]


@BilinearForm
def _product(u, v, w):
    return w.c * u * v


@LinearForm
def _total(v, _):
    return v


class PlainSkin:
    """(K + s M) u = b of both sheets by scikit-fem alone, foils and all, solved as it stands.

    Unknowns: the coefficients of the top sheet, of the bottom sheet, then every foil's potential.
    sheets: K of each sheet at 1 S. films: K of all contact resistances, S. tie: from the unknowns
    that are free to all of them, where an ideal foil gives the sheet under it its own potential.
    """

    def __init__(self, scene, resolution):
        circuit, order = two_fields(scene.parts.skin, scene.parts.setup), resolution.order
        terminals = [terminal for terminal in circuit.terminals if terminal.contacts]
        contacts = [contact for terminal in terminals for contact in terminal.contacts]
        pixels = pixel_mesh(scene.parts.skin, contacts, resolution)
        self.scene, self.pixel, self.excitations = scene, pixels.pixel, circuit.excitations
        self.tiles = [tile_lines(scene.parts.skin, axis, resolution) for axis in (0, 1)]
        self.basis = Basis(pixels.mesh, quadrilateral(order), intorder=2 * order)
        N = self.basis.N
        self.size = 2 * N + len(terminals)
        one = spsolve(_product.assemble(self.basis, c=1.0).tocsc(), _total.assemble(self.basis))
        L = _laplacian.assemble(self.basis)
        self.sheets = [self._both(np.diag(where), L) for where in ([1, 0], [0, 1])]
        self.films = csr_matrix((self.size, self.size))
        self.tie = eye_array(self.size, format="lil")
        held = []
        for U, terminal in enumerate(terminals, start=2 * N):
            for contact in terminal.contacts:
                facets = pixels.facets(contact)
                if contact.ideal:
                    under = self.basis.get_dofs(facets).flatten()
                    self.tie[terminal.field * N + under, U] = one[under]
                    held.extend(terminal.field * N + under)
                else:
                    across = eye_array(N, self.size, k=terminal.field * N, format="lil")
                    across[:, U] = -one
                    foil = FacetBasis(
                        pixels.mesh, quadrilateral(order), facets=facets, intorder=2 * order
                    )
                    film = _product.assemble(foil, c=1 / contact.resistance)
                    self.films = self.films + across.T @ film @ across
        self.tie = self.tie.tocsc()[:, np.setdiff1d(np.arange(self.size), held)]

    def stiffness(self, top, bottom):
        """K in S of sheets of these sheet resistances in ohm/sq."""
        return self.sheets[0] / top + self.sheets[1] / bottom + self.films

    def mass(self, c):
        """M(c) in F; c in F/m², shape (row, column)."""
        M = _product.assemble(self.basis, c=c.ravel()[self.pixel][:, None])
        return self._both([[1, -1], [-1, 1]], M)

    def solve(self, press, frequency, interface=0):
        """u in V for 1 V between `high` and `low`, and the current into `high` in A.

        Floating foils carry no current, and so does a floating sheet.
        """
        skin = self.scene.skin
        s = laplace_variable(frequency, skin.foam.loss)
        K = self.stiffness(skin.top.sheet_resistance, skin.bottom.sheet_resistance)
        c = skin.foam.unpressed_capacitance_per_area * tile_map(
            self.scene.parts.skin, press, *self.tiles
        )
        A = K + s * self.mass(c)
        A = (self.tie.T @ A @ self.tie).tocsr()
        first_foil = A.shape[0] - (self.size - 2 * self.basis.N)
        excitation = self.excitations[interface]
        high, low = (first_foil + np.array(side) for side in (excitation.high, excitation.low))
        free = np.setdiff1d(np.arange(A.shape[0]), [*high, *low])
        u = np.zeros(A.shape[0], dtype=complex)
        u[high] = 1.0
        u[free] = spsolve(A[free][:, free].tocsc(), -(A[free] @ u))
        return self.tie @ u, (A[high] @ u).sum()

    def _both(self, coupling, matrix):
        """One matrix for both sheets from that of one; nothing at the foils."""
        both = kron(coupling, matrix).tocsr()
        both.resize(self.size, self.size)
        return both


@pytest.fixture(scope="session")
def plain_skin():
    """The class of a skin solved in the plainest way, from a scene and a resolution."""
    return PlainSkin


@pytest.fixture(scope="session")
def varied(make_scene):
    """A function of further keys of a skin by dotted path, and of what `make_scene` takes.

    Contacts are named ELECTRODE-EDGE with an optional -SUFFIX, on any outline.
    """

    def varied(skin, contacts=None, interfaces=None, **keywords):
        tables = make_scene(**keywords).model_dump(by_alias=True, exclude_none=True)
        for path, value in skin.items():
            *parents, last = path.split(".")
            table = tables["skin"]
            for part in parents:
                table = table.setdefault(part, {})
            table[last] = value
        if contacts:
            names = list(contacts)
            tables["contact"] = [
                dict(zip(("electrode", "edge"), name.split("-"), strict=False), name=name) | more
                for name, more in contacts.items()
            ]
            pairs = interfaces or {"meter": (names[:1], names[1:2])}
            tables["interface"] = [
                {"name": name, "high": high, "low": low} for name, (high, low) in pairs.items()
            ]
        return Scene.model_validate(tables)

    return varied


@pytest.fixture(scope="session")
def off():
    """A function of Z and the true one: relative errors of Rs and Cp, shape (2, ...)."""

    def off(Z, truth):
        Y, true_Y = 1 / Z, 1 / truth
        return np.abs([Z.real / truth.real - 1, Y.imag / true_Y.imag - 1])

    return off
