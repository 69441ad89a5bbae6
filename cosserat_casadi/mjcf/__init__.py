"""Scenes as models of MuJoCo: rods become chains of rigid links."""
