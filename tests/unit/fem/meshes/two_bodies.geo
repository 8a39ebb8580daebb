// Two bodies of hexahedra, end to end and skewed, nodes at binary fractions. The meshes beside it:
// gmsh -3 two_bodies.geo -format msh41 -o two_bodies.msh; gmsh two_bodies.msh -save -format inp -o
// two_bodies.inp; python3 -c "import meshio; meshio.read('two_bodies.msh').write('two_bodies_meshio.inp')"
Point(1) = {0, 0, 0};
l[] = Extrude {0.09375, 0, 0.015625} { Point{1}; Layers{2}; };
e[] = Extrude {0, 0.0625, 0.00390625} { Curve{l[1]}; Layers{2}; Recombine; };
v[] = Extrude {0.03125, 0, 0.1875} { Surface{e[1]}; Layers{4}; Recombine; };
w[] = Extrude {0.015625, 0, 0.125} { Surface{v[0]}; Layers{2}; Recombine; };
Physical Volume("foot") = {v[1]};
Physical Volume("head") = {w[1]};
Physical Surface("clamp") = {e[1]};
Physical Surface("end") = {w[0]};
Physical Surface("side") = {v[2], w[2]};
Physical Curve("edge") = {l[1]};
Mesh.SaveGroupsOfNodes = 1;
