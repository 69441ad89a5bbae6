"""The site: the pages of docs/, the references that are made when it is built, and a gallery of the examples.

``pages`` lays all pages out in one folder, ``build`` has MkDocs make the site of them. What it shows is written once:
its contents are those of docs/index.md, its gallery is the runs of examples/demo.py.
"""
