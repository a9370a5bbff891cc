"""The papers behind the methods, as BibTeX."""

from __future__ import annotations

from collections.abc import Iterable

from matpoint.errors import InputError

#: Key → BibTeX entry.
CITATIONS: dict[str, str] = {
    "sulsky1994": """\
@article{sulsky1994,
  author = {Sulsky, Deborah and Chen, Zhen and Schreyer, Howard L.},
  title = {A particle method for history-dependent materials},
  journal = {Computer Methods in Applied Mechanics and Engineering},
  volume = {118},
  number = {1--2},
  pages = {179--196},
  year = {1994},
  doi = {10.1016/0045-7825(94)90112-0},
}""",
    "harlow1964": """\
@incollection{harlow1964,
  author = {Harlow, Francis H.},
  title = {The particle-in-cell computing method for fluid dynamics},
  booktitle = {Methods in Computational Physics},
  volume = {3},
  pages = {319--343},
  publisher = {Academic Press},
  year = {1964},
}""",
    "brackbill1986": """\
@article{brackbill1986,
  author = {Brackbill, Jeremiah U. and Ruppel, Hans M.},
  title = {{FLIP}: A method for adaptively zoned, particle-in-cell calculations of fluid flows in
    two dimensions},
  journal = {Journal of Computational Physics},
  volume = {65},
  number = {2},
  pages = {314--343},
  year = {1986},
  doi = {10.1016/0021-9991(86)90211-1},
}""",
    "cundall1987": """\
@incollection{cundall1987,
  author = {Cundall, Peter A.},
  title = {Distinct element models of rock and soil structure},
  booktitle = {Analytical and Computational Methods in Engineering Rock Mechanics},
  editor = {Brown, Edwin T.},
  pages = {129--163},
  publisher = {Allen and Unwin},
  year = {1987},
}""",
    "monaghan1994": """\
@article{monaghan1994,
  author = {Monaghan, Joseph J.},
  title = {Simulating free surface flows with {SPH}},
  journal = {Journal of Computational Physics},
  volume = {110},
  number = {2},
  pages = {399--406},
  year = {1994},
  doi = {10.1006/jcph.1994.1034},
}""",
    "simo1998": """\
@book{simo1998,
  author = {Simo, Juan C. and Hughes, Thomas J. R.},
  title = {Computational Inelasticity},
  publisher = {Springer},
  year = {1998},
  doi = {10.1007/b98904},
}""",
    "bonet2008": """\
@book{bonet2008,
  author = {Bonet, Javier and Wood, Richard D.},
  title = {Nonlinear Continuum Mechanics for Finite Element Analysis},
  edition = {2},
  publisher = {Cambridge University Press},
  year = {2008},
  doi = {10.1017/CBO9780511755446},
}""",
    "bardenhagen2002": """\
@article{bardenhagen2002,
  author = {Bardenhagen, Scott G.},
  title = {Energy conservation error in the material point method for solid mechanics},
  journal = {Journal of Computational Physics},
  volume = {180},
  number = {1},
  pages = {383--403},
  year = {2002},
  doi = {10.1006/jcph.2002.7103},
}""",
    "bardenhagen2004": """\
@article{bardenhagen2004,
  author = {Bardenhagen, Scott G. and Kober, Edward M.},
  title = {The generalized interpolation material point method},
  journal = {Computer Modeling in Engineering and Sciences},
  volume = {5},
  number = {6},
  pages = {477--495},
  year = {2004},
  doi = {10.3970/cmes.2004.005.477},
}""",
    "wallstedt2007": """\
@article{wallstedt2007,
  author = {Wallstedt, Philip C. and Guilkey, James E.},
  title = {Improved velocity projection for the material point method},
  journal = {Computer Modeling in Engineering and Sciences},
  volume = {19},
  number = {3},
  pages = {223--232},
  year = {2007},
  doi = {10.3970/cmes.2007.019.223},
}""",
    "wallstedt2011": """\
@article{wallstedt2011,
  author = {Wallstedt, Philip C. and Guilkey, James E.},
  title = {A weighted least squares particle-in-cell method for solid mechanics},
  journal = {International Journal for Numerical Methods in Engineering},
  volume = {85},
  number = {13},
  pages = {1687--1704},
  year = {2011},
  doi = {10.1002/nme.3041},
}""",
    "steffen2008": """\
@article{steffen2008,
  author = {Steffen, Michael and Kirby, Robert M. and Berzins, Martin},
  title = {Analysis and reduction of quadrature errors in the material point method ({MPM})},
  journal = {International Journal for Numerical Methods in Engineering},
  volume = {76},
  number = {6},
  pages = {922--948},
  year = {2008},
  doi = {10.1002/nme.2360},
}""",
    "sadeghirad2011": """\
@article{sadeghirad2011,
  author = {Sadeghirad, Alireza and Brannon, Rebecca M. and Burghardt, Jeffrey},
  title = {A convected particle domain interpolation technique to extend applicability of the
    material point method for problems involving massive deformations},
  journal = {International Journal for Numerical Methods in Engineering},
  volume = {86},
  number = {12},
  pages = {1435--1456},
  year = {2011},
  doi = {10.1002/nme.3110},
}""",
    "sadeghirad2013": """\
@article{sadeghirad2013,
  author = {Sadeghirad, Alireza and Brannon, Rebecca M. and Guilkey, James E.},
  title = {Second-order convected particle domain interpolation ({CPDI2}) with enrichment for weak
    discontinuities at material interfaces},
  journal = {International Journal for Numerical Methods in Engineering},
  volume = {95},
  number = {11},
  pages = {928--952},
  year = {2013},
  doi = {10.1002/nme.4526},
}""",
    "jiang2015": """\
@article{jiang2015,
  author = {Jiang, Chenfanfu and Schroeder, Craig and Selle, Andrew and Teran, Joseph and Stomakhin,
    Alexey},
  title = {The affine particle-in-cell method},
  journal = {ACM Transactions on Graphics},
  volume = {34},
  number = {4},
  pages = {51:1--51:10},
  year = {2015},
  doi = {10.1145/2766996},
}""",
    "hammerquist2017": """\
@article{hammerquist2017,
  author = {Hammerquist, Chad C. and Nairn, John A.},
  title = {A new method for material point method particle updates that reduces noise and enhances
    stability},
  journal = {Computer Methods in Applied Mechanics and Engineering},
  volume = {318},
  pages = {724--738},
  year = {2017},
  doi = {10.1016/j.cma.2017.01.035},
}""",
    "nairn2021": """\
@article{nairn2021,
  author = {Nairn, John A. and Hammerquist, Chad C.},
  title = {Material point method simulations using an approximate full mass matrix inverse},
  journal = {Computer Methods in Applied Mechanics and Engineering},
  volume = {377},
  pages = {113667},
  year = {2021},
  doi = {10.1016/j.cma.2021.113667},
}""",
    "wobbes2019": """\
@article{wobbes2019,
  author = {Wobbes, Elizaveta and M{\\"o}ller, Matthias and Galavi, Vahid and Vuik, Cornelis},
  title = {Conservative {Taylor} least squares reconstruction with application to material point
    methods},
  journal = {International Journal for Numerical Methods in Engineering},
  volume = {117},
  number = {3},
  pages = {271--290},
  year = {2019},
  doi = {10.1002/nme.5956},
}""",
    "nguyen2017": """\
@article{nguyen2017,
  author = {Nguyen, Vinh Phu and Nguyen, Chi Thanh and Rabczuk, Timon and Natarajan, Sundararajan},
  title = {On a family of convected particle domain interpolations in the material point method},
  journal = {Finite Elements in Analysis and Design},
  volume = {126},
  pages = {50--64},
  year = {2017},
  doi = {10.1016/j.finel.2016.11.007},
}""",
    "leavy2019": """\
@article{leavy2019,
  author = {Leavy, R. Brian and Guilkey, James E. and Phung, Bao R. and Spear, Ashley D. and
    Brannon, Rebecca M.},
  title = {A convected-particle tetrahedron interpolation technique in the material-point method for
    the mesoscale modeling of ceramics},
  journal = {Computational Mechanics},
  volume = {64},
  pages = {563--583},
  year = {2019},
  doi = {10.1007/s00466-019-01670-9},
}""",
    "tran2019": """\
@inproceedings{tran2019,
  author = {Tran, Quoc-Anh and Berzins, Martin and So{\\l}owski, Wojciech T.},
  title = {An improved moving least squares method for the material point method},
  booktitle = {Proceedings of the 2nd International Conference on the Material Point Method for
    Modelling Soil-Water-Structure Interaction (MPM 2019)},
  editor = {Liang, Dongfang and Kumar, Krishna and Rohe, Alexander},
  publisher = {Ocean Press},
  year = {2019},
  note = {Article mpm2019.06},
}""",
}


def bibtex(keys: Iterable[str]) -> str:
    """Return the BibTeX entries of some keys, each once, in the order of their years.

    Parameters
    ----------
    keys
        Keys of :data:`CITATIONS`, such as a material's ``citation``.

    Raises
    ------
    InputError
        A key is unknown.
    """
    wanted = set(keys)
    unknown = wanted - CITATIONS.keys()
    if unknown:
        raise InputError(f"unknown citations {sorted(unknown)}; there are {', '.join(CITATIONS)}")
    ordered = sorted(wanted, key=lambda key: (key[-4:], key))
    return "\n\n".join(CITATIONS[key] for key in ordered) + ("\n" if ordered else "")
