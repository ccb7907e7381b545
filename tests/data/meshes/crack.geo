Include "plate.geo";
Mesh 2;
Plugin(Crack).Dimension = 1;
Plugin(Crack).PhysicalGroup = 5;
Plugin(Crack).Run;
Save "gmsh_crack.msh";
