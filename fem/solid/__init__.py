"""The elastic body: elements, assembly, modes, reduction, full model. It knows no case file and no contact law."""
